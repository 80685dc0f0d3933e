// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

namespace soft_robot_lab {

// Of an eye as rviz's Orbit has it, with z up: `yaw` about z from x on, `pitch` above the plane of x and y.
struct EyeAngles {
  double yaw_rad, pitch_rad;
};

struct Framing {
  Eigen::Vector3d focus_m = Eigen::Vector3d::Zero();  // what it looks at
  double distance_m = 0.0;                            // from there
};

// So that a robot in this box is seen whole, with what is written around it, and with room to bend to both sides.
// `aspect`: width over height of the window, > 0.
Framing framing_of(const Eigen::AlignedBox3d& robot_m, const EyeAngles& eye, double aspect);

}  // namespace soft_robot_lab
