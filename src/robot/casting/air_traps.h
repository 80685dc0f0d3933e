// SPDX-License-Identifier: BSD-3-Clause
// Where air is caught while silicone rises between two halves: under local tops of their cavity, and under level roofs,
// along which air creeps slowly.
#pragma once

#include <vector>

#include "ray_tree.h"

namespace soft_robot_lab {

struct AirTrap {
  double across_m = 0;  // its middle, along the frame's first axis
  double height_m = 0;  // along the third, where the silicone rises to
  double above_m = 0;   // where silicone begins again above it; infinite: nowhere
};

// The highest first. What is looked at is the section of the robot at the parting plane, across the frame's second
// axis: sections farther out are no larger, or the halves did not come off, so that all air comes there.
std::vector<AirTrap> find_air_traps(const RayTree& robot, const Eigen::Matrix3d& frame, double parting_m);

}  // namespace soft_robot_lab
