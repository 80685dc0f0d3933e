// SPDX-License-Identifier: BSD-3-Clause
// The robots that the panel offers. Knows no window.
#pragma once

#include <string>
#include <vector>

namespace soft_robot_lab {

struct RobotChoice {
  std::string label;
  std::string file;
};

// "gripper"; of a scene that stands over that robot's file "gripper: ball".
std::string label_of(const std::string& scene);

// Of a folder like config/robots: each robot, and behind it the scenes beside it that stand over it, by name.
std::vector<RobotChoice> robot_choices(const std::string& folder);

}  // namespace soft_robot_lab
