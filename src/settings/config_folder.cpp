// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/settings/config_folder.h"

#include <filesystem>

#include "find_program.h"

namespace soft_robot_lab {

std::string config_folder() {
  std::error_code ignored;
  // Programs lie in lib/soft_robot_lab; the interpreter, of a module that Debian's package installs, in bin.
  for (const char* share : {"../../share", "../share"}) {
    const std::filesystem::path installed =
        (std::filesystem::path(program_folder()) / share / "soft_robot_lab/config").lexically_normal();
    if (std::filesystem::is_directory(installed, ignored)) return installed.string();
  }
  return SOFT_ROBOT_LAB_CONFIG;
}

}  // namespace soft_robot_lab
