// SPDX-License-Identifier: BSD-3-Clause
#include "drawn_parts.h"

#include <cmath>
#include <sstream>

namespace soft_robot_lab::drawn {

using Eigen::Vector3d;

Vector3d direction(Dice& dice) {
  const double height = dice.between(-1.0, 1.0), turn_rad = dice.between(0.0, 2.0 * M_PI),
               radius = std::sqrt(1.0 - height * height);
  return {radius * std::cos(turn_rad), radius * std::sin(turn_rad), height};
}

std::ostream& operator<<(std::ostream& out, const Vector3d& v) {
  return out << '[' << v.x() << ", " << v.y() << ", " << v.z() << ']';
}

std::string motion(double motion_s, const Vector3d& way_m, const Vector3d& turn_rad) {
  std::ostringstream text;
  text.precision(17);
  text << "motion: [{time_s: 0}, {time_s: " << motion_s << ", translation_m: " << way_m
       << ", rotation_rad: " << turn_rad << "}]";
  return text.str();
}

std::string shape(const std::string& kind, const Vector3d& at_m, double radius_m, const Vector3d& across_m) {
  std::ostringstream text;
  text.precision(17);
  if (kind == "ball")
    text << "sphere: {center_m: " << at_m << ", radius_m: " << radius_m << "}";
  else if (kind == "box")
    text << "box: {center_m: " << at_m << ", size_m: " << Vector3d(radius_m * Vector3d(2.0, 4.0, 2.0)) << "}";
  else
    text << (kind == "post" ? "cylinder" : "capsule") << ": {start_m: " << Vector3d(at_m - across_m)
         << ", end_m: " << Vector3d(at_m + across_m) << ", radius_m: " << radius_m << "}";
  return text.str();
}

}  // namespace soft_robot_lab::drawn
