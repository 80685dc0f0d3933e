// SPDX-License-Identifier: BSD-3-Clause
#include "closest_point.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace soft_robot_lab {
namespace {

Eigen::Vector3d nearest_on_segment(const Eigen::Vector3d& point, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d side = b - a;
  const double length2 = side.squaredNorm();
  return length2 > 0 ? Eigen::Vector3d(a + std::clamp((point - a).dot(side) / length2, 0.0, 1.0) * side) : a;
}

double distance2(const Eigen::Vector3d& point, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                 const Eigen::Vector3d& c) {
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const bool within = normal.dot((b - a).cross(point - a)) >= 0 && normal.dot((c - b).cross(point - b)) >= 0 &&
                      normal.dot((a - c).cross(point - c)) >= 0;
  if (within && normal.squaredNorm() > 0) {
    const double height = normal.dot(point - a);
    return height * height / normal.squaredNorm();
  }
  return std::min({(point - nearest_on_segment(point, a, b)).squaredNorm(),
                   (point - nearest_on_segment(point, b, c)).squaredNorm(),
                   (point - nearest_on_segment(point, c, a)).squaredNorm()});
}

}  // namespace

ClosestPoint closest_point(const Eigen::Vector3d& point_m, const Eigen::Matrix3Xd& vertices_m,
                           const Eigen::Matrix3Xi& triangles, int guess) {
  ClosestPoint closest;
  double best2 = std::numeric_limits<double>::infinity();
  const auto look_at = [&](int t) {
    const double found2 = distance2(point_m, vertices_m.col(triangles(0, t)), vertices_m.col(triangles(1, t)),
                                    vertices_m.col(triangles(2, t)));
    if (found2 >= best2) return;
    best2 = found2;
    closest = {t, std::sqrt(found2)};
  };
  if (guess >= 0) look_at(guess);
  for (int t = 0; t < triangles.cols(); ++t) {
    // A box about the triangle that is further off than the best so far holds no better one.
    double box2 = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double a = vertices_m(axis, triangles(0, t)), b = vertices_m(axis, triangles(1, t)),
                   c = vertices_m(axis, triangles(2, t));
      const double off = std::max({std::min({a, b, c}) - point_m[axis], point_m[axis] - std::max({a, b, c}), 0.0});
      box2 += off * off;
      if (box2 >= best2) break;
    }
    if (box2 < best2) look_at(t);
  }
  return closest;
}

}  // namespace soft_robot_lab
