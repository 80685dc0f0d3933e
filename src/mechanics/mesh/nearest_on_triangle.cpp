// SPDX-License-Identifier: BSD-3-Clause
#include "nearest_on_triangle.h"

namespace soft_robot_lab {

NearestOnTriangle nearest_on_triangle(const Eigen::Vector3d& point_m, const Eigen::Matrix3d& corners_m) {
  const Eigen::Vector3d a = corners_m.col(0), b = corners_m.col(1), c = corners_m.col(2), ab = b - a, ac = c - a;
  const Eigen::Vector3d ap = point_m - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return {a, -1, 0};
  const Eigen::Vector3d bp = point_m - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return {b, -1, 1};
  const Eigen::Vector3d cp = point_m - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return {c, -1, 2};
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return {a + d1 / (d1 - d3) * ab, 0, -1};
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) return {b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b), 1, -1};
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return {a + d2 / (d2 - d6) * ac, 2, -1};
  return {a + (vb * ab + vc * ac) / (va + vb + vc), -1, -1};
}

}  // namespace soft_robot_lab
