// SPDX-License-Identifier: BSD-3-Clause
// What xpbd finds and says where things touch.
#include <gtest/gtest.h>

#include "contact_bodies.h"

namespace soft_robot_lab {
namespace {

using Eigen::Vector3d;

// A plate comes down on a block at rest: 0.1 mm through the air, then 1 mm into it.
Simulation pressed(SolverOptions::Method method) {
  SolverOptions options;
  options.method = method;
  options.tolerance = 1e-4;
  Body body(box_mesh({-0.01, -0.01, 0}, {0.01, 0.01, 0.02}, {3, 3, 3}), {264200.0, 0.45, 1070.0});
  body.fix_nodes({-1, -1, -1}, {1, 1, 1e-6}, {true, true, true});
  body.set_obstacles(
      {{"plate", RoundedBox{{0, 0, 0.0251}, {0.1, 0.1, 0.01}, 0.0005}, {{0.0}, {1.0, {0, 0, -0.0011}}}, 0.0}});
  return Simulation(std::move(body), {}, {}, options);
}

TEST(XpbdContact, RestsUnderWhatComesDownOnABodyAtRest) {
  Simulation newton = pressed(SolverOptions::Method::newton), swept = pressed(SolverOptions::Method::xpbd);
  ASSERT_TRUE(newton.solve_equilibrium().converged);
  const SolveReport report = swept.solve_equilibrium();
  ASSERT_TRUE(report.converged) << report.message;
  const double expected_n = newton.contacts()[0].normal_force_n;
  EXPECT_GT(expected_n, 5.0);
  EXPECT_NEAR(swept.contacts()[0].normal_force_n, expected_n, 0.01 * expected_n);
}

TEST(XpbdContact, AStepThatLeavesMoreThanTheLargestForceHasNotConverged) {
  Simulation simulation = pressed(SolverOptions::Method::xpbd);
  SimulationState state = simulation.state();
  state.velocities_m_s.row(2).setConstant(-20.0);
  simulation.set_state(state);
  for (int i = 0; i < 4; ++i) {
    const SolveReport report = simulation.step();
    EXPECT_TRUE(!report.converged || report.residual <= 1.0) << report.residual;
  }
}

}  // namespace
}  // namespace soft_robot_lab
