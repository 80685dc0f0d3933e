#include <cstdlib>
#include <filesystem>
#include <sstream>

#include <unistd.h>

#include "scene/sections.h"

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

std::string find_mesher() {
  const char* name = "mesh_robot";
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  std::vector<fs::path> folders{program.parent_path()};
  std::istringstream path(environment("PATH"));
  for (std::string folder; std::getline(path, folder, ':');) folders.push_back(folder);
  for (const fs::path& folder : folders) {
    if (fs::is_regular_file(folder / name, error) && access((folder / name).c_str(), X_OK) == 0) {
      return (folder / name).string();
    }
  }
  throw std::invalid_argument(std::string(name) + " stands neither beside " + program.string() + " nor on PATH");
}

std::string find_cache_folder() {
  const std::string cache = environment("XDG_CACHE_HOME");
  if (fs::path(cache).is_absolute()) return cache + "/soft_robot_lab";
  const std::string home = environment("HOME");
  if (home.empty()) throw std::invalid_argument("no folder for meshes: neither XDG_CACHE_HOME nor HOME is set");
  return home + "/.cache/soft_robot_lab";
}

}  // namespace

MesherOptions mesher_options(const SceneOptions& options) {
  return {options.mesher.empty() ? find_mesher() : options.mesher,
          options.cache_folder.empty() ? find_cache_folder() : options.cache_folder, options.meshing_limit_s};
}

}  // namespace soft_robot_lab
