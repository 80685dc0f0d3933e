// SPDX-License-Identifier: BSD-3-Clause
#include "backward_difference.h"
#include "mechanics/solver_constants.h"

namespace soft_robot_lab {
BackwardDifference::BackwardDifference(const SimulationState& state, double h, StepRule rule) {
  if (rule == StepRule::trapezoidal) {
    trapezoidal = true;
    gamma_s = 0.5 * h;
    positions_from_m = state.positions_m + gamma_s * state.velocities_m_s;
    velocities_from_m_s = state.velocities_m_s + gamma_s * state.accelerations_m_s2;
    return;
  }
  const bool second_order = rule != StepRule::implicit_euler && state.previous_step_s > 0.0;
  const double w = second_order ? h / state.previous_step_s : 0.0;
  if (w == 0.0 || w > constants::kLargestGrowth) {
    gamma_s = h;
    positions_from_m = state.positions_m;
    velocities_from_m_s = state.velocities_m_s;
    return;
  }
  weight_now = (1.0 + w) * (1.0 + w) / (1.0 + 2.0 * w);
  weight_before = w * w / (1.0 + 2.0 * w);
  // After the trapezoidal stage both are equal but for rounding, which would cost a new factor.
  gamma_s = rule == StepRule::bdf2 ? h * (1.0 + w) / (1.0 + 2.0 * w) : 0.5 * state.previous_step_s;
  positions_from_m = weight_now * state.positions_m - weight_before * state.previous_positions_m;
  velocities_from_m_s = weight_now * state.velocities_m_s - weight_before * state.previous_velocities_m_s;
}

}  // namespace soft_robot_lab
