// SPDX-License-Identifier: BSD-3-Clause
#include "prediction.h"
#include "mechanics/solver_constants.h"

namespace soft_robot_lab {
namespace {

bool smooth(const SimulationState& state, double h) {
  return state.previous_step_s > 0.0 && h <= constants::kLargestGrowth * state.previous_step_s &&
         (state.velocities_m_s - state.previous_velocities_m_s).norm() <=
             constants::kLargestChange * state.velocities_m_s.norm();
}

// Multipliers that would change sign stop at zero, where a cable goes slack.
Eigen::VectorXd extrapolated(const Eigen::VectorXd& now, const Eigen::VectorXd& before, double share) {
  const Eigen::ArrayXd next = (now + share * (now - before)).array();
  return (next * now.array() > 0.0).select(next, 0.0);
}

// Only where there was and will be any: what opens or closes is left to the search.
Eigen::VectorXd extrapolated_pressures(const Eigen::VectorXd& now_pa, const Eigen::VectorXd& before_pa, double share) {
  const Eigen::ArrayXd next_pa = (now_pa + share * (now_pa - before_pa)).array();
  return (now_pa.array() > 0.0 && before_pa.array() > 0.0 && next_pa > 0.0).select(next_pa, now_pa);
}

}  // namespace

NewtonState predict(const SimulationState& state, double h, StepRule rule) {
  NewtonState start{state.positions_m + h * state.velocities_m_s, state.element_multipliers_pa,
                    state.constraint_multipliers};
  start.contact = state.contact;
  if (!smooth(state, h)) return start;
  // implicit_euler's velocity is that of the middle of its step, the others' that of the end.
  const double before_s = state.previous_step_s, since_s = rule == StepRule::implicit_euler ? h + before_s : h;
  start.positions_m += (0.5 * h * since_s / before_s) * (state.velocities_m_s - state.previous_velocities_m_s);
  const double share = h / before_s;
  start.element_multipliers_pa += share * (state.element_multipliers_pa - state.previous_element_multipliers_pa);
  start.constraint_multipliers =
      extrapolated(state.constraint_multipliers, state.previous_constraint_multipliers, share);
  start.contact.pressures_pa = extrapolated_pressures(state.contact.pressures_pa, state.previous_pressures_pa, share);
  return start;
}

}  // namespace soft_robot_lab
