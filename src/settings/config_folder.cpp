// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/settings/config_folder.h"

#include <filesystem>

#include "find_program.h"

namespace soft_robot_lab {

std::string config_folder() {
  std::error_code ignored;
  const std::filesystem::path here = program_folder();
  const std::filesystem::path installed = (here / "../../share/soft_robot_lab/config").lexically_normal();
  return std::filesystem::is_directory(installed, ignored) ? installed.string() : SOFT_ROBOT_LAB_CONFIG;
}

}  // namespace soft_robot_lab
