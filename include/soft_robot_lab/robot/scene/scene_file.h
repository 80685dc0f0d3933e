// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace soft_robot_lab {

// Whether it reads as a scene or a robot, with what it includes: it has a body, and keys of scenes only. Nothing is
// meshed.
bool is_scene_file(const std::string& path);

}  // namespace soft_robot_lab
