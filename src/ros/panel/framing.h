// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

namespace soft_robot_lab {

// Of an eye that looks along y, with z up.
struct Framing {
  Eigen::Vector3d focus_m = Eigen::Vector3d::Zero();  // what it looks at
  double distance_m = 0.0;                            // from there
};

// So that a robot in this box is seen whole, with what is written above it, and with room to bend to both sides.
Framing framing_of(const Eigen::AlignedBox3d& robot_m);

}  // namespace soft_robot_lab
