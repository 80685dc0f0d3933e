// SPDX-License-Identifier: BSD-3-Clause
// Two pads close on a loose thing and lift it. What friction holds goes along; a rest state in one long stage left it
// on the floor, which is one too.
#include <gtest/gtest.h>

#include "box_mesh.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {
namespace {

constexpr double kHalf_m = 0.00875;  // of the box's edge
constexpr double kLift_m = 0.02, kAside_m = 0.015;
const Eigen::Vector3d kStill = Eigen::Vector3d::Zero();

// Pads of 10 x 20 x 40 mm, held at their upper ends, that come 3.4 mm too near for the box, then go up and turn towards
// it, and then go aside.
Simulation pads(double friction, double unit_s = 1.0, double turn_rad = 0.0, bool stacked = false) {
  const double gap_m = 0.005, close_m = gap_m + 0.0034, x_m = kHalf_m + gap_m;
  TetMesh mesh = box_mesh({x_m, -0.01, 0.002}, {x_m + 0.01, 0.01, 0.042}, {1, 2, 4});
  add_body("left", box_mesh({-x_m - 0.01, -0.01, 0.002}, {-x_m, 0.01, 0.042}, {1, 2, 4}), mesh);
  Body body(std::move(mesh), {{80e3, 0.49, 1070.0}, {80e3, 0.49, 1070.0}});
  for (const double side : {1.0, -1.0}) {
    const Eigen::Vector3d closed(-side * close_m, 0, 0), up = closed + Eigen::Vector3d(0, 0, kLift_m),
                                                         aside = up + Eigen::Vector3d(0, kAside_m, 0);
    const Eigen::Vector3d turned(0.0, side * turn_rad, 0.0);
    body.fix_nodes({side > 0.0 ? 0.0 : -1.0, -1, 0.041}, {side > 0.0 ? 1.0 : 0.0, 1, 1}, {true, true, true},
                   {{0.0}, {unit_s, closed, kStill}, {2.0 * unit_s, up, turned}, {3.0 * unit_s, aside, turned}},
                   side > 0.0 ? "right" : "left");
  }
  body.set_gravity({0, 0, -9.81});
  body.set_viscosity({20.0, 0.01, 0.01, 1.0});
  Obstacle box{"box", RoundedBox{{0, 0, kHalf_m}, Eigen::Vector3d::Constant(2.0 * kHalf_m), 0.0009}, {}, friction};
  box.mass_kg = 0.0095;
  std::vector<Obstacle> obstacles = {box, {"floor", Plane{}, {}, friction}};
  if (stacked) {
    const RoundedBox lid{{0, 0, 2.0 * kHalf_m + 0.003}, {0.01, 0.01, 0.006}, 0.0006};
    obstacles.push_back({"lid", lid, {}, friction});
    obstacles.back().mass_kg = 0.001;
    obstacles.back().friction_on = {{"box", friction}};
  }
  body.set_obstacles(std::move(obstacles));
  SolverOptions options;
  options.time_step_s = 0.02;
  return Simulation(std::move(body), {}, {}, options);
}

Eigen::Vector3d box_of(const Simulation& simulation) { return simulation.state().contact.free.centers_m.col(0); }

TEST(Grip, TakesAlongWhatFrictionHolds) {
  Simulation slow = pads(0.8, 3.0);
  while (slow.state().time_s < 10.0) slow.step();
  ASSERT_GT(box_of(slow).z(), kHalf_m + 0.9 * kLift_m) << "in time it is lifted";
  ASSERT_GT(box_of(slow).y(), 0.9 * kAside_m) << "and carried aside";
  Simulation simulation = pads(0.8);
  const SolveReport report = simulation.solve_equilibrium();
  ASSERT_TRUE(report.converged) << report.message;
  EXPECT_LT((box_of(simulation) - box_of(slow)).norm(), 1e-4) << box_of(simulation).transpose();
}

// Where it is after a slow motion in time is written down: that takes long.
TEST(Grip, TakesAlongWhatPadsHoldThatTurnMeanwhile) {
  Simulation simulation = pads(0.8, 1.0, 0.06);
  const SolveReport report = simulation.solve_equilibrium();
  ASSERT_TRUE(report.converged) << report.message;
  EXPECT_LT((box_of(simulation) - Eigen::Vector3d(0, kAside_m, 0.02828)).norm(), 5e-5)
      << box_of(simulation).transpose();
}

TEST(Grip, TakesAlongWhatLiesOnWhatIsHeld) {
  Simulation simulation = pads(0.8, 1.0, 0.0, true);
  const SolveReport report = simulation.solve_equilibrium();
  ASSERT_TRUE(report.converged) << report.message;
  EXPECT_GT(box_of(simulation).z(), kHalf_m + 0.9 * kLift_m);
  const Eigen::Vector3d lid_m = simulation.state().contact.free.centers_m.col(1);
  EXPECT_LT((lid_m - box_of(simulation) - Eigen::Vector3d(0, 0, kHalf_m + 0.003)).norm(), 1e-4) << lid_m.transpose();
}

// One pad and a jaw that is an obstacle, 2.5 mm too near for the box.
Simulation pad_and_jaw(double unit_s) {
  const double gap_m = 0.003, close_m = gap_m + 0.00125, x_m = kHalf_m + gap_m;
  Body body(box_mesh({x_m, -0.01, 0.002}, {x_m + 0.01, 0.01, 0.032}, {1, 2, 3}), {{120e3, 0.49, 1070.0}});
  const auto motion = [&](double side) -> std::vector<ObstaclePose> {
    const Eigen::Vector3d closed(-side * close_m, 0, 0), up = closed + Eigen::Vector3d(0, 0, kLift_m);
    return {{0.0}, {unit_s, closed, kStill}, {2.0 * unit_s, up, kStill}};
  };
  body.fix_nodes({0, -1, 0.031}, {1, 1, 1}, {true, true, true}, motion(1.0), "pad");
  body.set_gravity({0, 0, -9.81});
  body.set_viscosity({20.0, 0.01, 0.01, 1.0});
  Obstacle box{"box", RoundedBox{{0, 0, kHalf_m}, Eigen::Vector3d::Constant(2.0 * kHalf_m), 0.0009}, {}, 0.6};
  box.mass_kg = 0.004;
  box.friction_on = {{"jaw", 0.6}};
  const RoundedBox jaw{{-x_m - 0.005, 0, 0.017}, {0.01, 0.02, 0.03}, 0.0005};
  body.set_obstacles({box, {"floor", Plane{}, {}, 0.6}, {"jaw", jaw, motion(-1.0), 0.6}});
  SolverOptions options;
  options.time_step_s = 0.02;
  return Simulation(std::move(body), {}, {}, options);
}

TEST(Grip, TakesAlongWhatAJawHoldsThatIsAnObstacle) {
  Simulation slow = pad_and_jaw(3.0);
  while (slow.state().time_s < 7.0) slow.step();
  ASSERT_GT(box_of(slow).z(), kHalf_m + 0.9 * kLift_m) << "in time it is lifted";
  Simulation simulation = pad_and_jaw(1.0);
  const SolveReport report = simulation.solve_equilibrium();
  ASSERT_TRUE(report.converged) << report.message;
  EXPECT_LT((box_of(simulation) - box_of(slow)).norm(), 1e-4) << box_of(simulation).transpose();
}

TEST(Grip, LeavesBehindWhatIsTooSlippery) {
  Simulation simulation = pads(0.02);
  const SolveReport report = simulation.solve_equilibrium();
  ASSERT_TRUE(report.converged) << report.message;
  EXPECT_NEAR(box_of(simulation).z(), kHalf_m, 1e-5);
}

}  // namespace
}  // namespace soft_robot_lab
