// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

namespace soft_robot_lab {

// Everything of an actuator that changes. Plain numbers: copy it to save and restore.
struct DriveState {
  double command = 0.0;           // as last commanded
  double actuated_command = 0.0;  // as reached within the speed limit
  double wait_s = 0.0;            // until the drive starts to move
  // The actuator's own, of one size always and finite: what it carries from step to step, and what it needs to know of
  // where the present step began.
  Eigen::VectorXd memory;
};

bool operator==(const DriveState& a, const DriveState& b);  // to the last bit
inline bool operator!=(const DriveState& a, const DriveState& b) { return !(a == b); }

// Of all actuators, in their order.
using DriveStates = std::vector<DriveState>;

}  // namespace soft_robot_lab
