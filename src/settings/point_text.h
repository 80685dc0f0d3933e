// SPDX-License-Identifier: BSD-3-Clause
// A point as messages write it: "(x, y, z) m".
#pragma once

#include <sstream>
#include <string>

#include <Eigen/Core>

namespace soft_robot_lab {

inline std::string point_text(const Eigen::Vector3d& at_m) {
  std::ostringstream text;
  text << "(" << at_m.x() << ", " << at_m.y() << ", " << at_m.z() << ") m";
  return text.str();
}

}  // namespace soft_robot_lab
