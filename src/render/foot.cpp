#include "render/foot.h"

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

Foot find_foot(const Eigen::Vector3d& point_m, const Eigen::Matrix3Xd& vertices_m, const Eigen::Matrix3Xi& triangles) {
  Foot foot;
  double best2 = std::numeric_limits<double>::infinity();
  for (int t = 0; t < triangles.cols(); ++t) {
    const Eigen::Vector3d a = vertices_m.col(triangles(0, t)), b = vertices_m.col(triangles(1, t)),
                          c = vertices_m.col(triangles(2, t));
    // No place of the triangle is further from its first corner than its longer side there.
    const double reach = std::sqrt(std::max((b - a).squaredNorm(), (c - a).squaredNorm()));
    const double least = (point_m - a).norm() - reach;
    if (least > 0 && least * least > best2) continue;
    const double found2 = distance2(point_m, a, b, c);
    if (found2 >= best2) continue;
    best2 = found2;
    foot = {t, std::sqrt(found2)};
  }
  return foot;
}

}  // namespace soft_robot_lab
