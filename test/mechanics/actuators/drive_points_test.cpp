// SPDX-License-Identifier: BSD-3-Clause
// Drives and pulleys outside the silicone.
#include <cmath>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "mechanics/box_mesh.h"
#include "soft_robot_lab/mechanics/actuators/cable.h"
#include "soft_robot_lab/mechanics/simulation.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

// Along x from 0 to 100 mm, 20 x 20 mm, held at x = 0.
Body held_bar(std::vector<ObstaclePose> motion = {}) {
  Body body(box_mesh({0, -0.01, -0.01}, {0.1, 0.01, 0.01}, {5, 2, 2}), Material{264200.0, 0.4, 1070.0});
  body.fix_nodes({-1, -1, -1}, {1e-6, 1, 1}, Eigen::Matrix<bool, 3, 1>::Constant(true), std::move(motion), "clamp");
  return body;
}

Simulation bar_with(const std::string& cable_settings, Body body = held_bar()) {
  const MeshLocator locator(body.mesh());
  std::vector<std::unique_ptr<Actuator>> actuators;
  if (!cable_settings.empty()) {
    actuators.push_back(std::make_unique<Cable>());
    actuators.back()->initialise(YamlNode::parse("{name: cable, " + cable_settings + "}", "bar.yaml"), body, locator);
  }
  return Simulation(std::move(body), std::move(actuators), {}, SolverOptions());
}

Eigen::Vector3d total_n(const Simulation& simulation) { return simulation.reaction_forces_n().rowwise().sum(); }

const Eigen::Vector3d kPulley_m(0.02, 0.06, 0.0), kDrive_m(-0.03, 0.06, 0.01);
const std::string kDrivePoints = "drive_points_m: [[-0.03, 0.06, 0.01], [0.02, 0.06, 0]], ";
const std::string kPlug = "points_m: [[0.095, 0, 0]], plug_radius_m: 0.003";

TEST(DrivePoints, CountInTheLength) {
  const ActuatorReading rest = bar_with(kDrivePoints + kPlug).actuator_state(0);
  const double expected_m = (kPulley_m - kDrive_m).norm() + (kPulley_m - Eigen::Vector3d(0.095, 0, 0)).norm();
  EXPECT_NEAR(*rest.rest_length_m, expected_m, 1e-12);
  ASSERT_EQ(rest.path_m.size(), 3u);
  EXPECT_LT((rest.path_m[0] - kDrive_m).norm() + (rest.path_m[1] - kPulley_m).norm(), 1e-12);
}

// The robot feels the pull of the last span alone, along the line from its plug to the pulley.
TEST(DrivePoints, PullAsAForceTowardsThePulley) {
  const double tension_n = 0.05;
  for (const std::string model : {"sliding", "friction, friction_coefficient: 0"}) {
    SCOPED_TRACE(model);
    Simulation pulled = bar_with(kDrivePoints + kPlug + ", command: tension_n, model: " + model);
    pulled.set_command("cable", tension_n);
    ASSERT_TRUE(pulled.solve_equilibrium().converged);
    const std::vector<Eigen::Vector3d> path_m = pulled.actuator_state(0).path_m;
    EXPECT_LT((path_m[0] - kDrive_m).norm() + (path_m[1] - kPulley_m).norm(), 1e-12) << "they stand still";
    EXPECT_GT((path_m[2] - Eigen::Vector3d(0.095, 0, 0)).norm(), 1e-3);
    Simulation expected = bar_with("");
    const EmbeddedPoint plug =
        MeshLocator(expected.body().mesh()).embed_disc({0.095, 0, 0}, Eigen::Vector3d(0.095, 0, 0) - kPulley_m, 0.003);
    expected.pull(plug, tension_n * (kPulley_m - path_m[2]).normalized());
    ASSERT_TRUE(expected.solve_equilibrium().converged);
    EXPECT_LT((pulled.state().positions_m - expected.state().positions_m).colwise().norm().maxCoeff(), 1e-7);
    EXPECT_LT(total_n(pulled).norm(), 1e-6) << "drive and pulleys stand on the clamp";
  }
}

// Where the clamp moves the frame goes along, and nothing is pulled.
TEST(DrivePoints, GoAlongWithAHoldThatMoves) {
  Simulation simulation = bar_with(kDrivePoints + kPlug, held_bar({{0.0}, {1.0, {0.01, 0.02, 0.0}}}));
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  const ActuatorReading moved = simulation.actuator_state(0);
  EXPECT_LT((moved.path_m[0] - kDrive_m - Eigen::Vector3d(0.01, 0.02, 0)).norm(), 1e-9);
  EXPECT_NEAR(*moved.length_m, *moved.rest_length_m, 1e-7);
}

TEST(DrivePoints, AreRefusedWithPlaceAndReason) {
  const auto refusal = [](const std::string& settings, Body body) -> std::string {
    try {
      bar_with(settings, std::move(body));
    } catch (const SettingsError& error) {
      return error.what();
    }
    return "accepted";
  };
  Body loose(box_mesh({0, -0.01, -0.01}, {0.1, 0.01, 0.01}, {5, 2, 2}), Material{264200.0, 0.4, 1070.0});
  EXPECT_NE(refusal(kDrivePoints + kPlug, std::move(loose)).find("drive_points_m[0]: stands on the frame"),
            std::string::npos);
  EXPECT_NE(
      refusal("drive_points_m: [[0, 0.05]], " + kPlug, held_bar()).find("drive_points_m[0]: a point is [x, y, z]"),
      std::string::npos);
  EXPECT_NE(refusal("drive_points_m: [[0, 0.05, 0], [0, 0.05, 0]], " + kPlug, held_bar())
                .find("drive_points_m[1]: repeats the point beside it"),
            std::string::npos);
  EXPECT_NE(refusal(kPlug, held_bar()).find("points_m: a cable needs at least two points"), std::string::npos);
}

}  // namespace
}  // namespace soft_robot_lab
