// SPDX-License-Identifier: BSD-3-Clause
#include "state_check.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <stdexcept>

#include "settings/require.h"

namespace soft_robot_lab {
namespace {

struct Size {
  Eigen::Index has, fits;
  bool may_be_empty = false;
};

bool fit(std::initializer_list<Size> sizes) {
  return std::all_of(sizes.begin(), sizes.end(),
                     [](const Size& size) { return size.has == size.fits || (size.may_be_empty && size.has == 0); });
}

bool same_sizes(const FreeVelocities& a, Eigen::Index columns) {
  return fit({{a.linear_m_s.cols(), columns}, {a.angular_rad_s.cols(), columns}});
}

bool same_sizes(const FreePoses& a, Eigen::Index columns) {
  return fit({{a.centers_m.cols(), columns}, {a.turns.cols(), columns}});
}

template <class... Numbers>
bool all_finite(const Numbers&... numbers) {
  return (numbers.allFinite() && ...);
}

bool finite(const FreeVelocities& a) { return a.linear_m_s.allFinite() && a.angular_rad_s.allFinite(); }

// A turn is a quaternion of length 1.
bool sound(const FreePoses& a) {
  return a.centers_m.allFinite() && a.turns.allFinite() &&
         (a.turns.cols() == 0 || (a.turns.colwise().norm().array() - 1.0).abs().maxCoeff() < 1e-6);
}

bool free_sizes(const SimulationState& state, const SimulationState& now) {
  const Eigen::Index count = now.contact.free.centers_m.cols();
  const Eigen::Index before = state.previous_step_s != 0.0 ? count : 0;
  return same_sizes(state.contact.free, count) && same_sizes(state.contact.free_before, count) &&
         same_sizes(state.free_velocities, count) && same_sizes(state.previous_free, before) &&
         same_sizes(state.previous_free_velocities, before) &&
         fit({{state.contact.rigid_forces_n.size(), now.contact.rigid_forces_n.size()},
              {state.contact.rigid_ties_m.cols(), now.contact.rigid_ties_m.cols()},
              {state.free_forces_n.cols(), state.accelerations_m_s2.cols() > 0 ? 2 * count : 0}});
}

bool sizes_now(const SimulationState& state, const SimulationState& now) {
  const Eigen::Index nodes = now.positions_m.cols();
  return fit({{state.positions_m.cols(), nodes},
              {state.velocities_m_s.cols(), now.velocities_m_s.cols()},
              {state.element_multipliers_pa.size(), now.element_multipliers_pa.size()},
              {state.constraint_multipliers.size(), now.constraint_multipliers.size()},
              {state.contact.pressures_pa.size(), now.contact.pressures_pa.size()},
              {state.contact.anchors_m.cols(), now.contact.anchors_m.cols()},
              {state.element_forces_n.size(), now.element_forces_n.size(), true},
              {state.branch_stress_pa.size(), now.branch_stress_pa.size()},
              {state.accelerations_m_s2.cols(), nodes, true},
              {state.hold_inertia_n.cols(), nodes, true}}) &&
         std::equal(state.drives.begin(), state.drives.end(), now.drives.begin(), now.drives.end(),
                    [](const auto& a, const auto& b) { return a.memory.size() == b.memory.size(); });
}

// Of the step before, where there is one.
bool sizes_before(const SimulationState& state, const SimulationState& now) {
  const auto then = [&](Eigen::Index size) { return state.previous_step_s != 0.0 ? size : 0; };
  return fit({{state.previous_positions_m.cols(), then(now.positions_m.cols())},
              {state.previous_velocities_m_s.cols(), then(now.positions_m.cols())},
              {state.previous_element_multipliers_pa.size(), then(now.element_multipliers_pa.size())},
              {state.previous_constraint_multipliers.size(), then(now.constraint_multipliers.size())},
              {state.previous_pressures_pa.size(), then(now.contact.pressures_pa.size())}});
}

bool free_finite(const SimulationState& state) {
  return sound(state.contact.free) && sound(state.contact.free_before) && sound(state.previous_free) &&
         finite(state.free_velocities) && finite(state.previous_free_velocities) &&
         all_finite(state.free_forces_n, state.contact.rigid_forces_n, state.contact.rigid_ties_m) &&
         std::isfinite(state.contact.before_s);
}

bool finite(const SimulationState& state) {
  return all_finite(state.positions_m, state.velocities_m_s, state.element_multipliers_pa, state.constraint_multipliers,
                    state.contact.pressures_pa, state.contact.anchors_m, state.element_forces_n, state.branch_stress_pa,
                    state.hold_inertia_n, state.accelerations_m_s2) &&
         all_finite(state.previous_positions_m, state.previous_velocities_m_s, state.previous_element_multipliers_pa,
                    state.previous_constraint_multipliers, state.previous_pressures_pa) &&
         std::isfinite(state.time_s) && std::isfinite(state.contact.time_s) &&
         std::all_of(state.drives.begin(), state.drives.end(), [](const DriveState& drive) {
           return std::isfinite(drive.actuated_command) && std::isfinite(drive.wait_s) && drive.memory.allFinite();
         });
}

}  // namespace

void check_state(const SimulationState& state, const SimulationState& now) {
  if (!sizes_now(state, now) || !sizes_before(state, now) || !free_sizes(state, now))
    throw std::invalid_argument("state: its sizes are not those of this simulation");
  require(state.previous_step_s >= 0.0 && state.previous_step_s <= 1.0, "state.previous_step_s", state.previous_step_s,
          "[0, 1]");
  require(state.inverted_steps >= 0, "state.inverted_steps", state.inverted_steps, "zero or more");
  if (!free_finite(state))
    throw std::invalid_argument("state: of free obstacles not finite, or a turn not of length 1");
  if (!finite(state)) throw std::invalid_argument("state: not finite");
}

}  // namespace soft_robot_lab
