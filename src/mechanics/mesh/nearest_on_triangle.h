// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace soft_robot_lab {

// Where a triangle is nearest to a point: in itself, on one of its sides 01, 12, 20, or at one of its corners.
struct NearestOnTriangle {
  Eigen::Vector3d at_m;
  int side = -1, corner = -1;  // -1: not there
};

// Ericson 2005, section 5.1.5. Of a triangle with an area.
NearestOnTriangle nearest_on_triangle(const Eigen::Vector3d& point_m, const Eigen::Matrix3d& corners_m);

}  // namespace soft_robot_lab
