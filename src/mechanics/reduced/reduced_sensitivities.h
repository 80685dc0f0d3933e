// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "reduced_simulation.h"

namespace soft_robot_lab {

struct ReducedSensitivities {
  bool stable = false;          // false: there is no stable equilibrium, and all else is empty
  Eigen::MatrixXd q;            // d q / d command, modes x actuators
  Eigen::MatrixXd multipliers;  // d multiplier of each constraint / d command, constraints x actuators
};

// At an equilibrium, by the implicit function theorem, as NewtonSolver::respond: with S = K^-1 B,
//   (B' S + compliance) dy = d offset  on active constraints,  dq = -S dy
ReducedSensitivities reduced_sensitivities(const ReducedModel& model, const ReducedState& state);

}  // namespace soft_robot_lab
