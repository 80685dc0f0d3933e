// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/mechanics/simulation_state.h"

#include <cstring>

namespace soft_robot_lab {
namespace {

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof(double)) == 0; }

template <class Numbers>
bool same_bits(const Numbers& a, const Numbers& b) {
  if (a.rows() != b.rows() || a.cols() != b.cols()) return false;
  return a.size() == 0 || std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(double)) == 0;
}

bool same_bits(const std::optional<double>& a, const std::optional<double>& b) {
  return a.has_value() == b.has_value() && (!a || same_bits(*a, *b));
}

bool same_bits(const FreeVelocities& a, const FreeVelocities& b) {
  return same_bits(a.linear_m_s, b.linear_m_s) && same_bits(a.angular_rad_s, b.angular_rad_s);
}

bool same_bits(const FreePoses& a, const FreePoses& b) {
  return same_bits(a.centers_m, b.centers_m) && same_bits(a.turns, b.turns);
}

bool same_previous_step(const SimulationState& a, const SimulationState& b) {
  return same_bits(a.previous_step_s, b.previous_step_s) && same_bits(a.previous_positions_m, b.previous_positions_m) &&
         same_bits(a.previous_velocities_m_s, b.previous_velocities_m_s) &&
         same_bits(a.previous_element_multipliers_pa, b.previous_element_multipliers_pa) &&
         same_bits(a.previous_constraint_multipliers, b.previous_constraint_multipliers) &&
         same_bits(a.previous_pressures_pa, b.previous_pressures_pa) && same_bits(a.previous_free, b.previous_free) &&
         same_bits(a.previous_free_velocities, b.previous_free_velocities) &&
         same_bits(a.accelerations_m_s2, b.accelerations_m_s2) && same_bits(a.free_forces_n, b.free_forces_n);
}

}  // namespace

std::vector<double> SimulationState::commands() const {
  std::vector<double> all;
  for (const DriveState& drive : drives) all.push_back(drive.command);
  return all;
}

std::vector<double> SimulationState::actuated_commands() const {
  std::vector<double> all;
  for (const DriveState& drive : drives) all.push_back(drive.actuated_command);
  return all;
}

void SimulationState::take_commands(const SimulationState& from) {
  for (std::size_t i = 0; i < drives.size(); ++i) {
    drives[i].command = from.drives.at(i).command;
    drives[i].actuated_command = from.drives.at(i).actuated_command;
  }
}

bool operator==(const DriveState& a, const DriveState& b) {
  return same_bits(a.command, b.command) && same_bits(a.actuated_command, b.actuated_command) &&
         same_bits(a.wait_s, b.wait_s) && same_bits(a.memory, b.memory);
}

bool operator==(const SimulationState& a, const SimulationState& b) {
  return same_bits(a.time_s, b.time_s) && same_bits(a.positions_m, b.positions_m) &&
         same_bits(a.velocities_m_s, b.velocities_m_s) &&
         same_bits(a.element_multipliers_pa, b.element_multipliers_pa) &&
         same_bits(a.constraint_multipliers, b.constraint_multipliers) &&
         same_bits(a.element_forces_n, b.element_forces_n) && same_bits(a.branch_stress_pa, b.branch_stress_pa) &&
         same_bits(a.hold_inertia_n, b.hold_inertia_n) && a.drives == b.drives && a.contact == b.contact &&
         same_bits(a.free_velocities, b.free_velocities) && same_bits(a.rest_residual, b.rest_residual) &&
         a.inverted_steps == b.inverted_steps && same_previous_step(a, b);
}

}  // namespace soft_robot_lab
