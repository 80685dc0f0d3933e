// SPDX-License-Identifier: BSD-3-Clause
// What every drive of a rig has, motor or pressure channel.
#pragma once

#include <string>

namespace soft_robot_lab {

struct DriveLimits {
  std::string name;        // of the actuator, as in the scene
  double min_value = 0.0;  // of the actuator's command
  double max_value = 0.0;
  std::string min_key, max_key;  // of the rig's file, which set them; empty: none does
};

}  // namespace soft_robot_lab
