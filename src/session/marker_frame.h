// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace soft_robot_lab {

struct SeenMarker {
  std::string name;
  Eigen::Vector3d position_m;  // robot_base; finite
};

// What cameras saw at one instant, and nothing that was estimated.
struct MarkerFrame {
  double time_s = 0.0;
  std::vector<SeenMarker> seen;
};

}  // namespace soft_robot_lab
