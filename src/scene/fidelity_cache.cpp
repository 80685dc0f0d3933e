#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "scene/fidelity.h"
#include "scene/fidelity_json.h"

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;

fs::path place(const std::string& key, const SceneOptions& options) {
  return fs::path(cache_folder(mesher_options(options))) / (key + ".fidelity.json");
}

}  // namespace

std::optional<FidelityReport> find_fidelity(const std::string& key, const SceneOptions& options) {
  std::ifstream file(place(key, options));
  if (!file) return std::nullopt;
  try {
    nlohmann::ordered_json json;
    file >> json;
    FidelityReport report = fidelity_from_json(json);
    report.from_cache = true;
    return report;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;  // a damaged file is made anew
  }
}

void keep_fidelity(const std::string& key, const FidelityReport& report, const SceneOptions& options) {
  const fs::path path = place(key, options), part = path.string() + "." + std::to_string(getpid()) + ".part";
  fs::create_directories(path.parent_path());
  nlohmann::ordered_json json = fidelity_json(report);
  json["cpu_s"] = report.cpu_s;
  std::ofstream(part) << json.dump(2) << "\n";
  fs::rename(part, path);  // whole or not at all, also for a second process
}

}  // namespace soft_robot_lab
