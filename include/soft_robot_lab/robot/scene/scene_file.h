// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace soft_robot_lab {

// Whether it reads as a scene or a robot, with what it includes: it has a body, and keys of scenes only. Nothing is
// meshed.
bool is_scene_file(const std::string& path);

// The robot's file: the last of those that include one another. The scene itself where it includes none.
std::string robot_file(const std::string& scene);

// What people call that robot: its folder where the file is a robot.yaml, else the file, without its ending.
std::string name_of_robot(const std::string& scene);

}  // namespace soft_robot_lab
