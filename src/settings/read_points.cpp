// SPDX-License-Identifier: BSD-3-Clause
#include "read_points.h"

#include "point_text.h"

namespace soft_robot_lab {

std::vector<Eigen::Vector3d> read_points(const YamlNode& owner, const std::string& key) {
  constexpr double kNear_m = 1e-6;  // points within 1e-7 are one for the kernel of solids
  std::vector<Eigen::Vector3d> points_m;
  for (const YamlNode& item : owner.sequence(key)) {
    const Eigen::VectorXd point = item.as_numbers();
    if (point.size() != 3) item.fail("a point is [x, y, z] in m");
    if (!points_m.empty() && (points_m.back() - point).norm() < kNear_m)
      item.fail("repeats the point before it, " + point_text(points_m.back()));
    points_m.emplace_back(point);
  }
  return points_m;
}

}  // namespace soft_robot_lab
