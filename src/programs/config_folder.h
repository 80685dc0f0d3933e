#pragma once

#include <filesystem>
#include <string>

namespace soft_robot_lab {

// The package's config/: beside an installed program in share/, otherwise in the sources this was built from.
inline std::string config_folder() {
  std::error_code ignored;
  const std::filesystem::path here = std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path();
  const std::filesystem::path installed = (here / "../../share/soft_robot_lab/config").lexically_normal();
  return std::filesystem::is_directory(installed, ignored) ? installed.string() : SOFT_ROBOT_LAB_CONFIG;
}

}  // namespace soft_robot_lab
