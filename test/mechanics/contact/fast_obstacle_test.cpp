// SPDX-License-Identifier: BSD-3-Clause
// Obstacles that are faster than a time step can follow.
#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "contact_bodies.h"
#include "mechanics/contact/fast_obstacles.h"

namespace soft_robot_lab {
namespace {

using Eigen::Vector3d;

Body block() {
  Body body(box_mesh({-0.01, -0.02, -0.01}, {0.01, 0, 0.01}, {2, 2, 2}), kSilicone);
  body.fix_nodes({-1, -1, -1}, {1, -0.02 + 1e-6, 1}, {true, true, true});
  return body;
}

Obstacle ball(const Vector3d& center_m, const Vector3d& velocity_m_s) {
  Obstacle one{"ball", Sphere{center_m, 0.005}, {}, 0.0};
  one.mass_kg = 0.004;
  one.velocity_m_s = velocity_m_s;
  return one;
}

Obstacle plate() { return {"plate", RoundedBox{{0, 0.05, 0}, {0.04, 0.004, 0.04}, 0.0004}, {}, 0.0}; }

Simulation with(std::vector<Obstacle> obstacles, SolverOptions options = {}) {
  Body body = block();
  body.set_obstacles(std::move(obstacles));
  return Simulation(std::move(body), {}, {}, options);
}

const SolveWarning* fast(const SolveReport& report) {
  const auto found = std::find_if(report.warnings.begin(), report.warnings.end(),
                                  [](const SolveWarning& warning) { return warning.kind == "fast_obstacle"; });
  return found == report.warnings.end() ? nullptr : &*found;
}

TEST(FastObstacle, ThatAStepCannotFollowIsNamed) {
  for (const SolverOptions::Method method : {SolverOptions::Method::newton, SolverOptions::Method::xpbd}) {
    SolverOptions options;
    options.method = method;
    Simulation simulation = with({ball({0, 0.02, 0}, {0, -900, 0})}, options);
    const SolveReport report = simulation.step();
    ASSERT_TRUE(fast(report));
    EXPECT_NEAR(fast(report)->size, 15.0, 1e-9);
    EXPECT_NE(fast(report)->text.find("obstacle 'ball'"), std::string::npos) << fast(report)->text;
    EXPECT_TRUE(simulation.state().positions_m.allFinite());
  }
}

TEST(FastObstacle, ThatAStepCanFollowIsNot) {
  Simulation simulation = with({ball({0, 0.02, 0}, {0, -2, 0})});
  const SolveReport report = simulation.step();
  EXPECT_FALSE(fast(report)) << fast(report)->text;
  EXPECT_GT(simulation.state().contact.free.centers_m(1, 0), 0.0);
}

// A bar that turns at 1e4 rad/s would pass through the block 26 times in a step; one whose turns are whole too.
TEST(FastObstacle, ThatTurnsFasterThanAStepCanFollowIsNamed) {
  for (const double turn_rad_s : {1e4, 120.0 * M_PI}) {
    Obstacle bar{"bar", RoundedBox{{0, 0.01, 0}, {0.03, 0.002, 0.002}, 0.0004}, {}, 0.0};
    bar.mass_kg = 0.004;
    bar.angular_velocity_rad_s = {0, 0, turn_rad_s};
    Simulation simulation = with({bar});
    const SolveReport report = simulation.step();
    ASSERT_TRUE(fast(report)) << turn_rad_s;
    EXPECT_NE(fast(report)->text.find("obstacle 'bar'"), std::string::npos) << fast(report)->text;
    EXPECT_TRUE(simulation.state().positions_m.allFinite());
  }
}

// 33 mm in a step, towards a plate 4 mm thick.
TEST(FastObstacle, DoesNotPassThroughAnotherObstacle) {
  SolverOptions options;
  Simulation simulation = with({ball({0, 0.07, 0}, {0, -2, 0}), plate()}, options);
  for (int i = 0; i < 3; ++i) {
    const SolveReport report = simulation.step();
    EXPECT_TRUE(report.converged) << report.message;
    EXPECT_FALSE(fast(report)) << fast(report)->text;
    EXPECT_GT(simulation.state().contact.free.centers_m(1, 0), 0.052);
  }
}

TEST(FastObstacle, WithoutAFiniteMotionAsksForEndlessPartsAndNoMore) {
  const Body body = [] {
    Body made = block();
    made.set_obstacles({ball({0, 0.02, 0}, Vector3d::Zero())});
    return made;
  }();
  const ContactTerm contact(body);
  ContactState state = contact.untouched(body.mesh().nodes_m, 0.0);
  FreeVelocities velocities = contact.free().velocities_at_start();
  velocities.linear_m_s(1, 0) = -1e300;
  const ObstacleCuts cuts =
      parts_for_obstacles(body, contact, body.mesh().nodes_m, Eigen::Matrix3Xd::Zero(3, body.mesh().node_count()),
                          state, velocities, 1.0 / 60.0);
  EXPECT_EQ(cuts.obstacle, 0);
  EXPECT_GT(cuts.parts, 1e290);
}

}  // namespace
}  // namespace soft_robot_lab
