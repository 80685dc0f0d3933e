// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/mechanics/simulation_state.h"

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

SimulationState some_state() {
  SimulationState state;
  state.time_s = 1.0;
  state.positions_m = Eigen::Matrix3Xd::Constant(3, 2, 0.1);
  state.velocities_m_s = Eigen::Matrix3Xd::Zero(3, 2);
  state.element_multipliers_pa = state.constraint_multipliers = Eigen::VectorXd::Ones(2);
  state.drives = {{1.0, 0.9, 0.1, Eigen::VectorXd::Ones(1)}};
  return state;
}

TEST(SimulationState, IsEqualToItsCopy) {
  const SimulationState state = some_state(), copy = state;
  EXPECT_TRUE(state == copy);
  EXPECT_FALSE(state != copy);
}

TEST(SimulationState, DiffersByAnySingleBit) {
  const double next = std::nextafter(0.1, 1.0);
  const std::vector<std::function<void(SimulationState&)>> overrides = {
      [&](SimulationState& s) { s.time_s = std::nextafter(1.0, 2.0); },
      [&](SimulationState& s) { s.positions_m(2, 1) = next; },
      [&](SimulationState& s) { s.velocities_m_s(0, 0) = -0.0; },
      [&](SimulationState& s) { s.element_multipliers_pa[1] = next; },
      [&](SimulationState& s) { s.constraint_multipliers.conservativeResize(1); },
      [&](SimulationState& s) { s.element_forces_n = Eigen::VectorXd::Zero(1); },
      [&](SimulationState& s) { s.branch_stress_pa = Eigen::VectorXd::Zero(1); },
      [&](SimulationState& s) { s.drives[0].command = next; },
      [&](SimulationState& s) { s.drives[0].actuated_command = next; },
      [&](SimulationState& s) { s.drives[0].wait_s = next; },
      [&](SimulationState& s) { s.drives[0].memory[0] = next; },
      [&](SimulationState& s) { s.drives.clear(); },
      [&](SimulationState& s) { s.rest_residual = 0.0; },
      [&](SimulationState& s) { s.inverted_steps = 1; },
      [&](SimulationState& s) { s.previous_step_s = next; },
      [&](SimulationState& s) { s.previous_positions_m = Eigen::Matrix3Xd::Zero(3, 1); },
      [&](SimulationState& s) { s.previous_velocities_m_s = Eigen::Matrix3Xd::Zero(3, 1); },
      [&](SimulationState& s) { s.previous_element_multipliers_pa = Eigen::VectorXd::Zero(1); },
      [&](SimulationState& s) { s.previous_constraint_multipliers = Eigen::VectorXd::Zero(1); },
      [&](SimulationState& s) { s.previous_pressures_pa = Eigen::VectorXd::Zero(1); },
  };
  for (std::size_t i = 0; i < overrides.size(); ++i) {
    SimulationState changed = some_state();
    overrides[i](changed);
    EXPECT_TRUE(changed != some_state()) << i;
  }
}

TEST(SimulationState, IsEqualWhereItHoldsTheSameNotANumber) {
  SimulationState one = some_state();
  one.time_s = std::numeric_limits<double>::quiet_NaN();
  const SimulationState other = one;
  EXPECT_TRUE(one == other);
}

TEST(SimulationState, TakesCommandsButNotMemories) {
  SimulationState from = some_state(), to = some_state();
  from.drives[0] = {0.5, 0.6, 0.2, Eigen::VectorXd::Zero(1)};
  to.take_commands(from);
  EXPECT_EQ(to.commands(), std::vector<double>{0.5});
  EXPECT_EQ(to.actuated_commands(), std::vector<double>{0.6});
  EXPECT_EQ(to.drives[0].memory[0], 1.0);
}

}  // namespace
}  // namespace soft_robot_lab
