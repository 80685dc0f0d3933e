// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "soft_robot_lab/robot/design/solid.h"

namespace soft_robot_lab {

// The STL, OBJ or STEP file that a key of a section names, relative to the file that states it, with the section's
// `scale`. Throws SettingsError.
Solid read_file_solid(const YamlNode& node, const std::string& key);

}  // namespace soft_robot_lab
