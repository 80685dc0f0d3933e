// SPDX-License-Identifier: BSD-3-Clause
#include "read_points.h"

#include <sstream>

namespace soft_robot_lab {

std::vector<Eigen::Vector3d> read_points(const YamlNode& owner, const std::string& key) {
  constexpr double kNear_m = 1e-9;
  std::vector<Eigen::Vector3d> points_m;
  for (const YamlNode& item : owner.sequence(key)) {
    const Eigen::VectorXd point = item.as_numbers();
    if (point.size() != 3) item.fail("a point is [x, y, z] in m");
    if (!points_m.empty() && (points_m.back() - point).norm() < kNear_m) {
      std::ostringstream text;
      text << "repeats the point before it, (" << point[0] << ", " << point[1] << ", " << point[2] << ") m";
      item.fail(text.str());
    }
    points_m.emplace_back(point);
  }
  return points_m;
}

}  // namespace soft_robot_lab
