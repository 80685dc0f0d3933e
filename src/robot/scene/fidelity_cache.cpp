// SPDX-License-Identifier: BSD-3-Clause
#include "fidelity.h"
#include "fidelity_json.h"
#include "settings/read_file.h"

namespace soft_robot_lab {
namespace {

constexpr const char* kFidelityEnding = ".fidelity.json";

}  // namespace

std::optional<FidelityReport> find_fidelity(const std::string& key, const SceneOptions& options) {
  const std::string path = cache_of(options).find(key, kFidelityEnding);
  if (path.empty()) return std::nullopt;
  try {
    FidelityReport report =
        fidelity_from_json(nlohmann::ordered_json::parse(read_regular_file(path, kLargestSettings_bytes)));
    report.from_cache = true;
    return report;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;  // of another version
  }
}

void keep_fidelity(const std::string& key, const FidelityReport& report, const SceneOptions& options) {
  cache_of(options).keep_text(kept_json(report).dump(2) + "\n", key, kFidelityEnding);
}

}  // namespace soft_robot_lab
