// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

// A list of points [x, y, z] in m, none within 1e-9 m of the one before it. Throws SettingsError.
std::vector<Eigen::Vector3d> read_points(const YamlNode& owner, const std::string& key);

}  // namespace soft_robot_lab
