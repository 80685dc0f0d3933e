// SPDX-License-Identifier: BSD-3-Clause
// A bar that its cable bends against a post: how its tip follows the command, against central differences.
#include <gtest/gtest.h>

#include "test_bar.h"

namespace soft_robot_lab {
namespace {

Simulation bar_at_post(double friction) {
  SolverOptions options;
  options.tolerance = 1e-10;
  const Obstacle post{"post", Cylinder{{0.017, -0.06, -1}, {0.017, -0.06, 1}, 0.005, 0.0005}, {}, friction};
  return hanging_bar("model: sliding", options, 1.0, {post});
}

Eigen::Vector3d tip_m(double friction, double command) {
  Simulation simulation = bar_at_post(friction);
  for (const double at : {0.98, command}) {
    simulation.set_command("cable", at);
    EXPECT_TRUE(simulation.solve_equilibrium().converged);
  }
  EXPECT_GT(simulation.contacts()[0].area_m2, 0.0);
  return simulation.marker_position(0);
}

TEST(ContactSensitivity, FollowsThePostAsDifferencesDo) {
  Simulation simulation = bar_at_post(0.0);
  for (const double command : {0.98, 0.95}) {
    simulation.set_command("cable", command);
    ASSERT_TRUE(simulation.solve_equilibrium().converged);
  }
  const Eigen::Vector3d exact = simulation.marker_sensitivities();
  const double change = 1e-6;
  const Eigen::Vector3d measured = (tip_m(0.0, 0.95 + change) - tip_m(0.0, 0.95 - change)) / (2.0 * change);
  EXPECT_LT((exact - measured).norm(), 1e-5 * measured.norm()) << exact.transpose() << " / " << measured.transpose();
}

}  // namespace
}  // namespace soft_robot_lab
