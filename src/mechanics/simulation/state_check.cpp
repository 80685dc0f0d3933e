// SPDX-License-Identifier: BSD-3-Clause
#include "state_check.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "settings/require.h"

namespace soft_robot_lab {
namespace {

bool same_sizes(const FreeVelocities& a, Eigen::Index columns) {
  return a.linear_m_s.cols() == columns && a.angular_rad_s.cols() == columns;
}

bool same_sizes(const FreePoses& a, Eigen::Index columns) {
  return a.centers_m.cols() == columns && a.turns.cols() == columns;
}

bool finite(const FreeVelocities& a) { return a.linear_m_s.allFinite() && a.angular_rad_s.allFinite(); }

// A turn is a quaternion of length 1.
bool sound(const FreePoses& a) {
  return a.centers_m.allFinite() && a.turns.allFinite() &&
         (a.turns.cols() == 0 || (a.turns.colwise().norm().array() - 1.0).abs().maxCoeff() < 1e-6);
}

bool free_sizes(const SimulationState& state, const SimulationState& now, bool history) {
  const Eigen::Index count = now.contact.free.centers_m.cols();
  return same_sizes(state.contact.free, count) && same_sizes(state.contact.free_before, count) &&
         same_sizes(state.free_velocities, count) && same_sizes(state.previous_free, history ? count : 0) &&
         same_sizes(state.previous_free_velocities, history ? count : 0) &&
         state.contact.rigid_forces_n.size() == now.contact.rigid_forces_n.size() &&
         state.contact.rigid_ties_m.cols() == now.contact.rigid_ties_m.cols();
}

bool free_finite(const SimulationState& state) {
  return sound(state.contact.free) && sound(state.contact.free_before) && sound(state.previous_free) &&
         finite(state.free_velocities) && finite(state.previous_free_velocities) && state.free_forces_n.allFinite() &&
         state.contact.rigid_forces_n.allFinite() && state.contact.rigid_ties_m.allFinite() &&
         std::isfinite(state.contact.before_s);
}

}  // namespace

void check_state(const SimulationState& state, const SimulationState& now) {
  const bool sizes =
      state.positions_m.cols() == now.positions_m.cols() && state.velocities_m_s.cols() == now.velocities_m_s.cols() &&
      state.element_multipliers_pa.size() == now.element_multipliers_pa.size() &&
      state.constraint_multipliers.size() == now.constraint_multipliers.size() &&
      state.contact.pressures_pa.size() == now.contact.pressures_pa.size() &&
      state.contact.anchors_m.cols() == now.contact.anchors_m.cols() &&
      (state.element_forces_n.size() == now.element_forces_n.size() || state.element_forces_n.size() == 0) &&
      state.branch_stress_pa.size() == now.branch_stress_pa.size() &&
      (state.accelerations_m_s2.cols() == now.positions_m.cols() || state.accelerations_m_s2.cols() == 0) &&
      state.free_forces_n.cols() == (state.accelerations_m_s2.cols() > 0 ? 2 * now.contact.free.centers_m.cols() : 0) &&
      (state.hold_inertia_n.cols() == now.positions_m.cols() || state.hold_inertia_n.cols() == 0) &&
      std::equal(state.drives.begin(), state.drives.end(), now.drives.begin(), now.drives.end(),
                 [](const auto& a, const auto& b) { return a.memory.size() == b.memory.size(); });
  const bool history = state.previous_step_s != 0.0;
  const bool previous_sizes =
      state.previous_positions_m.cols() == (history ? now.positions_m.cols() : 0) &&
      state.previous_velocities_m_s.cols() == (history ? now.positions_m.cols() : 0) &&
      state.previous_element_multipliers_pa.size() == (history ? now.element_multipliers_pa.size() : 0) &&
      state.previous_constraint_multipliers.size() == (history ? now.constraint_multipliers.size() : 0) &&
      state.previous_pressures_pa.size() == (history ? now.contact.pressures_pa.size() : 0);
  if (!sizes || !previous_sizes || !free_sizes(state, now, history))
    throw std::invalid_argument("state: its sizes are not those of this simulation");
  require(state.previous_step_s >= 0.0 && state.previous_step_s <= 1.0, "state.previous_step_s", state.previous_step_s,
          "[0, 1]");
  require(state.inverted_steps >= 0, "state.inverted_steps", state.inverted_steps, "zero or more");
  if (!free_finite(state))
    throw std::invalid_argument("state: of free obstacles not finite, or a turn not of length 1");
  if (!state.previous_positions_m.allFinite() || !state.previous_velocities_m_s.allFinite() ||
      !state.previous_element_multipliers_pa.allFinite() || !state.previous_constraint_multipliers.allFinite() ||
      !state.previous_pressures_pa.allFinite() || !state.positions_m.allFinite() || !state.velocities_m_s.allFinite() ||
      !state.element_multipliers_pa.allFinite() || !state.constraint_multipliers.allFinite() ||
      !std::isfinite(state.contact.time_s) || !state.contact.pressures_pa.allFinite() ||
      !state.contact.anchors_m.allFinite() || !state.element_forces_n.allFinite() ||
      !state.branch_stress_pa.allFinite() || !state.hold_inertia_n.allFinite() ||
      !state.accelerations_m_s2.allFinite() || !std::isfinite(state.time_s) ||
      !std::all_of(state.drives.begin(), state.drives.end(), [](const DriveState& drive) {
        return std::isfinite(drive.actuated_command) && std::isfinite(drive.wait_s) && drive.memory.allFinite();
      }))
    throw std::invalid_argument("state: not finite");
}

}  // namespace soft_robot_lab
