// SPDX-License-Identifier: BSD-3-Clause
// Where a simulation's markers and drives are.
#pragma once

#include <algorithm>
#include <cmath>

#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

inline Eigen::Matrix3Xd places(const Simulation& simulation) {
  Eigen::Matrix3Xd all(3, static_cast<Eigen::Index>(simulation.markers().size()));
  for (Eigen::Index m = 0; m < all.cols(); ++m) all.col(m) = simulation.marker_position(static_cast<int>(m));
  return all;
}

inline bool arrived(const DriveState& drive) { return std::abs(drive.actuated_command - drive.command) <= 1e-9; }

inline bool all_arrived(const Simulation& simulation) {
  const DriveStates& drives = simulation.state().drives;
  return std::all_of(drives.begin(), drives.end(), arrived);
}

}  // namespace soft_robot_lab
