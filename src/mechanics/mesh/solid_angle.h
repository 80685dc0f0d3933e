// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include <Eigen/Geometry>

namespace soft_robot_lab {

// Half of the solid angle of a triangle from the origin [sr], with the sign of its orientation (van Oosterom and
// Strackee 1983). Over a closed surface they add up to 2 pi or -2 pi where it surrounds the origin, else to 0.
inline double half_solid_angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return std::atan2(a.cross(b).dot(c), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

}  // namespace soft_robot_lab
