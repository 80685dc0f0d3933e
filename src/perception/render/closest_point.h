// SPDX-License-Identifier: BSD-3-Clause
// The place of a skin that is nearest to a point.
#pragma once

#include <Eigen/Core>

namespace soft_robot_lab {

struct ClosestPoint {
  int triangle = -1;  // -1 where there is no skin
  double distance_m = 0;
};

// Begins at the triangle `guess`, if it is one: the nearer it is, the quicker.
ClosestPoint closest_point(const Eigen::Vector3d& point_m, const Eigen::Matrix3Xd& vertices_m,
                           const Eigen::Matrix3Xi& triangles, int guess);

}  // namespace soft_robot_lab
