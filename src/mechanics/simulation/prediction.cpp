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
Eigen::VectorXd extrapolated(const Eigen::VectorXd& now, const Eigen::VectorXd& before, double volumetric_strain) {
  const Eigen::ArrayXd next = (now + volumetric_strain * (now - before)).array();
  return (next * now.array() > 0.0).select(next, 0.0);
}

}  // namespace

NewtonState predict(const SimulationState& state, double h, StepRule rule) {
  NewtonState start{state.positions_m + h * state.velocities_m_s, state.element_multipliers_pa,
                    state.constraint_multipliers};
  if (!smooth(state, h)) return start;
  // implicit_euler's velocity is that of the middle of its step, the others' that of the end.
  const double before_s = state.previous_step_s, since_s = rule == StepRule::implicit_euler ? h + before_s : h;
  start.positions_m += (0.5 * h * since_s / before_s) * (state.velocities_m_s - state.previous_velocities_m_s);
  const double volumetric_strain = h / before_s;
  start.element_multipliers_pa +=
      volumetric_strain * (state.element_multipliers_pa - state.previous_element_multipliers_pa);
  start.constraint_multipliers =
      extrapolated(state.constraint_multipliers, state.previous_constraint_multipliers, volumetric_strain);
  return start;
}

}  // namespace soft_robot_lab
