// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include <Eigen/Core>

namespace soft_robot_lab {

// Depth, in units of the direction, of a ball's near side, or of its far side from inside; 0 where it is missed.
inline float ball_depth(const Eigen::Vector3d& center_m, double radius_m, const Eigen::Vector3f& origin_m,
                        const Eigen::Vector3f& direction) {
  const Eigen::Vector3d from_centre = origin_m.cast<double>() - center_m, along = direction.cast<double>();
  const double a = along.squaredNorm(), b = from_centre.dot(along);
  const double discriminant = b * b - a * (from_centre.squaredNorm() - radius_m * radius_m);
  if (discriminant < 0) return 0;
  const double root = std::sqrt(discriminant), near = (-b - root) / a, far = (-b + root) / a;
  return static_cast<float>(near > 0 ? near : far > 0 ? far : 0);
}

}  // namespace soft_robot_lab
