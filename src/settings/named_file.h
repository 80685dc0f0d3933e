// SPDX-License-Identifier: BSD-3-Clause
// Files that a settings file names.
#pragma once

#include <string>

#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

// The whole path that this text stands for: a relative one starts at the folder of the file that states it. Throws
// SettingsError at the node's place where it is empty, or where the program would write over that file; whether there
// is such a file is not asked.
std::string named_file(const YamlNode& node);

}  // namespace soft_robot_lab
