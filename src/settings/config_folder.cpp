#include "soft_robot_lab/settings/config_folder.h"

#include <filesystem>

namespace soft_robot_lab {

std::string config_folder() {
  std::error_code ignored;
  const std::filesystem::path here = std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path();
  const std::filesystem::path installed = (here / "../../share/soft_robot_lab/config").lexically_normal();
  return std::filesystem::is_directory(installed, ignored) ? installed.string() : SOFT_ROBOT_LAB_CONFIG;
}

}  // namespace soft_robot_lab
