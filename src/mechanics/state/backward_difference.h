// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "soft_robot_lab/mechanics/simulation_state.h"
#include "soft_robot_lab/mechanics/solver_options.h"

namespace soft_robot_lab {

// By which one solve goes on. The last two are the stages of TR-BDF2 (Bank et al. 1985; Hosea & Shampine 1996).
enum class StepRule { implicit_euler, bdf2, trapezoidal, bdf2_after_trapezoidal };

// Of a step of TR-BDF2, over which the trapezoidal rule goes: 2 - sqrt(2), so that both stages have one matrix.
inline constexpr double kTrapezoidalShare = 0.58578643762690497;

// Backward differentiation over one step of length h, or over it and the one before:  y' = (y - from) / gamma.
// With w = h / previous h (Hairer, Norsett & Wanner 1993, III.5):
//   gamma = h (1 + w) / (1 + 2 w),   from = ((1 + w)^2 y1 - w^2 y2) / (1 + 2 w);   w = 0 is implicit Euler.
// The trapezoidal rule has this form too, with the slope where the step starts:  gamma = h / 2,  from = y1 + gamma y1'.
// Applied to x and v it gives  M (x - x~) / gamma^2 = force(x),  x~ = x_from + gamma v_from.
// For equal steps:  9/4 M (x - x~) / h^2 = force(x),  x~ = (4 x1 - x2) / 3 + 2/9 h (4 v1 - v2).
struct BackwardDifference {
  double gamma_s;
  double weight_now = 1.0, weight_before = 0.0;  // y_from = weight_now y1 - weight_before y2
  bool trapezoidal = false;                      // then y_from = y1 + gamma y1'
  Eigen::Matrix3Xd positions_from_m, velocities_from_m_s;

  // Of a trapezoidal step the state must know its accelerations.
  BackwardDifference(const SimulationState& state, double h, StepRule rule);
};

}  // namespace soft_robot_lab
