// SPDX-License-Identifier: BSD-3-Clause
// Bodies that are bent, turned, stretched, pressed or inflated far, and are stable all the way: nothing snapped.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "actuators/hollow_mesh.h"
#include "box_mesh.h"
#include "round_mesh.h"
#include "soft_robot_lab/mechanics/actuators/chamber.h"
#include "soft_robot_lab/mechanics/simulation.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

const Eigen::Vector3d kZero = Eigen::Vector3d::Zero(), kEnd(1, 1, 1);
constexpr double kYoungs_pa = 264200.0;

Simulation with_marker(Body body, const Eigen::Vector3d& at_m, std::vector<std::unique_ptr<Actuator>> actuators = {}) {
  std::vector<Marker> markers;
  markers.emplace_back("marker", at_m, body.mesh(), MeshLocator(body.mesh()));
  return Simulation(std::move(body), std::move(actuators), std::move(markers), {});
}

void expect_rest_without_warning(Simulation& simulation) {
  const SolveReport report = simulation.solve_equilibrium();
  EXPECT_TRUE(report.converged) << report.message;
  for (const SolveWarning& warning : report.warnings) ADD_FAILURE() << warning.kind << ": " << warning.text;
}

// The end of an elastica of length 1 under a force F at its end across it, with `load` = F L^2 / (E I). By Bisshopp and
// Drucker (1945, Q. Appl. Math. 3(3)): the table's along and across.
struct Elastica {
  double load, along, across;
};
constexpr std::array<Elastica, 4> kElastica{
    {{0.5, 0.98408, 0.16214}, {2.0, 0.83936, 0.49346}, {5.0, 0.61237, 0.71379}, {10.0, 0.44500, 0.81061}}};

TEST(StableWay, OfACantileverToAnElastica) {
  const double length_m = 0.1;
  for (const double width_m : {0.005, 0.01}) {
    for (const Elastica& truth : kElastica) {
      Body body(box_mesh({0, -width_m / 2, -width_m / 2}, {length_m, width_m / 2, width_m / 2}, {20, 2, 2}),
                {kYoungs_pa, 0.45, 1070.0});
      body.fix_nodes(-kEnd, {1e-6, 1, 1}, {true, true, true});
      const double force_n = truth.load * kYoungs_pa * std::pow(width_m, 4) / 12.0 / (length_m * length_m);
      body.add_force({length_m - 1e-6, -1, -1}, kEnd, {0, 0, -force_n});
      Simulation cantilever = with_marker(std::move(body), {length_m, 0, 0});
      SCOPED_TRACE(truth.load);
      expect_rest_without_warning(cantilever);
      const Eigen::Vector3d end_m(truth.along * length_m, 0, -truth.across * length_m);
      const Eigen::Vector3d off_m = cantilever.marker_position(0) - end_m;
      EXPECT_LT(off_m.norm(), 0.03 * (end_m - Eigen::Vector3d(length_m, 0, 0)).norm());
    }
  }
}

TEST(StableWay, OfABlockToThreeTimesItsLength) {
  Body body(box_mesh(kZero, {0.03, 0.02, 0.02}, {3, 2, 2}), {3e5, 0.4999, 1070.0});
  body.fix_nodes(-kEnd, {1e-6, 1, 1}, {true, false, false});
  body.fix_nodes({0.029999, -1, -1}, kEnd, {true, false, false}, {{}, {1.0, {0.06, 0, 0}, kZero}}, "right");
  body.fix_nodes(-kEnd, {1, 1e-6, 1}, {false, true, false});
  body.fix_nodes(-kEnd, {1, 1, 1e-6}, {false, false, true});
  Simulation block = with_marker(std::move(body), {0.03, 0.02, 0.02});
  expect_rest_without_warning(block);
  EXPECT_NEAR(block.marker_position(0).y(), 0.02 / std::sqrt(3.0), 2e-6);
}

TEST(StableWay, OfABarTurnedByHalfATurn) {
  for (const double width_m : {0.006, 0.02}) {
    Body body(box_mesh({-width_m / 2, -width_m / 2, 0}, {width_m / 2, width_m / 2, 0.1}, {2, 2, 12}),
              {kYoungs_pa, 0.4, 1070.0});
    body.fix_nodes(-kEnd, {1, 1, 1e-6}, {true, true, true});
    const std::vector<ObstaclePose> turn{{}, {1.0, kZero, {0, 0, M_PI / 2}}, {2.0, kZero, {0, 0, M_PI}}};
    body.fix_nodes({-1, -1, 0.099999}, kEnd, {true, true, true}, turn, "top");
    Simulation bar = with_marker(std::move(body), {width_m / 2, 0, 0.05});
    expect_rest_without_warning(bar);
    EXPECT_NEAR(bar.marker_position(0).y(), width_m / 2, 0.03 * width_m) << "half way up it has turned by a quarter";
  }
}

// Held in the planes of its symmetry; `depth_m` of its half.
Simulation pressed(Body body, double radius_m, double depth_m) {
  body.fix_nodes(-kEnd, {1e-6, 1, 1}, {true, false, false});
  body.fix_nodes({-1, -1e-6, -1}, {1, 1e-6, 1}, {false, true, false});
  body.fix_nodes(-kEnd, {1, 1, 1e-6}, {false, false, true});
  body.set_obstacles({{"lid", Plane{{0, 0, radius_m}, {0, 0, -1}}, {{}, {1.0, {0, 0, -depth_m}, kZero}}, 0.0}});
  return with_marker(std::move(body), {radius_m, 0, 0});
}

TEST(StableWay, OfAPressedBallAndAPressedRoller) {
  const double radius_m = 0.02;
  const Material rubber{kYoungs_pa, 0.4999, 1070.0};
  for (const double depth_m : {0.002, 0.006, 0.01}) {
    SCOPED_TRACE(depth_m);
    Simulation ball = pressed(Body(quarter_ball(radius_m, 4), rubber), radius_m, depth_m);
    expect_rest_without_warning(ball);
    // Of a half, by Hertz (1882), beyond which a ball between plates stiffens.
    const double hertz_n = 0.5 * 4.0 / 3.0 * kYoungs_pa / 0.75 * std::sqrt(radius_m) * std::pow(depth_m, 1.5);
    EXPECT_GT(ball.contacts()[0].normal_force_n, hertz_n);
    EXPECT_LT(ball.contacts()[0].normal_force_n, (depth_m < 0.11 * radius_m ? 1.25 : 2.5) * hertz_n);
    EXPECT_GT(ball.marker_position(0).x(), radius_m);
    Simulation roller = pressed(Body(quarter_disc(radius_m, 0.03, {4, 4}), rubber), radius_m, depth_m);
    expect_rest_without_warning(roller);
    EXPECT_GT(roller.marker_position(0).x(), radius_m);
  }
}

// A bending finger: a hollow nearer to one side, along most of it.
TEST(StableWay, OfAHangingFingerUnderPressure) {
  HollowLattice lattice{{mirrored({0.004, 0.0075}), mirrored({0.004, 0.0075}), mirrored({0.01, 0.02, 0.024})},
                        {-0.004, -0.004, -0.02},
                        {0.004, 0.004, 0.02},
                        true,
                        {}};
  lattice.map = [](const Eigen::Vector3d& at_m) -> Eigen::Vector3d {
    const double share = at_m.x() / 0.0075;
    return {at_m.x() + 0.0015 * (1.0 - share * share), at_m.y(), at_m.z()};
  };
  for (const double pressure_pa : {3000.0, 15000.0, 25000.0}) {
    SCOPED_TRACE(pressure_pa);
    Body body(hollow_mesh(lattice), {kYoungs_pa, 0.45, 1070.0});
    body.fix_nodes({-1, -1, 0.023999}, kEnd, {true, true, true});
    body.set_gravity({0, 0, -9.81});
    std::vector<std::unique_ptr<Actuator>> actuators;
    actuators.push_back(std::make_unique<Chamber>());
    actuators[0]->initialise(
        YamlNode::parse("{name: air, surface: cavity, command: gauge_pressure, max_gauge_pressure_pa: 50000}", "test"),
        body, MeshLocator(body.mesh()));
    Simulation finger = with_marker(std::move(body), {0, 0, -0.024}, std::move(actuators));
    finger.set_command("air", pressure_pa);
    expect_rest_without_warning(finger);
    EXPECT_NEAR(*finger.actuator_state(0).gauge_pressure_pa, pressure_pa, 1.0);
    EXPECT_LT(finger.marker_position(0).x(), 0.0) << "bends away from the thin wall";
  }
}

}  // namespace
}  // namespace soft_robot_lab
