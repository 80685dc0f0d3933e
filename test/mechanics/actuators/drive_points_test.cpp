// SPDX-License-Identifier: BSD-3-Clause
// Drives and pulleys outside the silicone, and cables that find their way around obstacles.
#include <cmath>
#include <memory>
#include <string>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "dense_sink.h"
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
  std::vector<Marker> markers;
  markers.emplace_back("tip", Eigen::Vector3d(0.1, 0, 0), body.mesh(), locator);
  return Simulation(std::move(body), std::move(actuators), std::move(markers), SolverOptions());
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
    expected.pull({{plug, tension_n * (kPulley_m - path_m[2]).normalized()}});
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

// A post above the bar, over which a cable leads from beside the clamp to the bar's end.
const Eigen::Vector3d kPost_m(0.05, 0.035, 0.0), kPostAlong_m(0.002, 0, 0.05);
constexpr double kPostRadius_m = 0.01;

Body bar_below_post() {
  Body body = held_bar();
  body.set_obstacles(
      {{"post", Cylinder{kPost_m - kPostAlong_m, kPost_m + kPostAlong_m, kPostRadius_m, 0.001}, {}, 0.0}});
  return body;
}

const std::string kOverPost =
    "drive_points_m: [[-0.02, 0.025, 0.004]], around: [{obstacle: post, by_m: [0.05, 0.05, 0]}], " + kPlug;

// Of a cable: value and log-ratio against their gradients, gradient against the Hessian. The cable crosses the post at
// a slant, and the shape is bent.
TEST(CableAround, HasTheDerivativesOfItsLengthAndAngle) {
  const Simulation simulation = bar_with(kOverPost + ", model: friction, friction_coefficient: 0.4", bar_below_post());
  const Simulation whole = bar_with(kOverPost, bar_below_post());
  Eigen::Matrix3Xd x = simulation.body().mesh().nodes_m;
  for (Eigen::Index i = 0; i < x.cols(); ++i) x.col(i) += Eigen::Vector3d(0, 0.5, 0.4) * std::pow(x(0, i), 2);
  const Actuator& cable = *simulation.actuators()[0];
  const Constraint& length = *whole.actuators()[0]->constraints()[0];
  const FrictionContact& contact = *cable.friction_contacts()[0];
  const DriveState drive = cable.rest_state();
  const auto gradient = [&](const Constraint& of, const Eigen::Matrix3Xd& at) {
    Eigen::Matrix3Xd sum = Eigen::Matrix3Xd::Zero(3, x.cols());
    of.add_gradient(at, drive, 1.0, sum);
    return sum;
  };
  const auto hessian = [&](const Constraint& of) {
    DenseSink sink(of, x.cols());
    of.add_hessian(x, drive, 1.0, sink);
    return sink.hessian;
  };
  EXPECT_GT(std::log(contact.ratio(x)), 0.4 * 0.5);
  Eigen::Matrix3Xd angle = Eigen::Matrix3Xd::Zero(3, x.cols());
  contact.add_log_ratio_gradient(x, 1.0, angle);
  const Eigen::Matrix3Xd slope = gradient(length, x);
  const Eigen::MatrixXd curved = hessian(length);
  const Constraint &first = *cable.constraints()[0], &last = *cable.constraints()[1];
  EXPECT_NEAR(first.value(x, drive) + last.value(x, drive), length.value(x, drive), 1e-12);
  EXPECT_LT((gradient(first, x) + gradient(last, x) - slope).norm(), 1e-12 * slope.norm());
  EXPECT_LT((hessian(first) + hessian(last) - curved).norm(), 1e-12 * curved.norm());
  double wrong = 0.0, wrong_angle = 0.0, wrong_slope = 0.0;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    if (slope.data()[i] == 0.0) continue;
    Eigen::Matrix3Xd plus = x, minus = x;
    plus.data()[i] += 1e-6;
    minus.data()[i] -= 1e-6;
    wrong =
        std::max(wrong, std::abs((length.value(plus, drive) - length.value(minus, drive)) / 2e-6 - slope.data()[i]));
    wrong_angle =
        std::max(wrong_angle, std::abs(std::log(contact.ratio(plus) / contact.ratio(minus)) / 2e-6 - angle.data()[i]));
    const Eigen::Matrix3Xd turned = (gradient(length, plus) - gradient(length, minus)) / 2e-6;
    wrong_slope =
        std::max(wrong_slope, (Eigen::Map<const Eigen::VectorXd>(turned.data(), turned.size()) - curved.col(i)).norm());
  }
  EXPECT_LT(wrong, 1e-6);
  EXPECT_LT(wrong_angle, 1e-4 * angle.norm());
  EXPECT_LT(wrong_slope, 1e-4 * curved.norm());
}

// Pulled, the far tension is that of the drive over exp(mu angle), with the angle by which the cable turns in all.
TEST(CableAround, RubsOnThePostAsACapstan) {
  for (const double mu : {0.0, 0.3, 0.6}) {
    Simulation simulation = bar_with(
        kOverPost + ", model: friction, friction_coefficient: 0.1, friction_on_obstacles: " + std::to_string(mu),
        bar_below_post());
    simulation.set_command("cable", 0.97);
    const SolveReport report = simulation.solve_equilibrium();
    ASSERT_TRUE(report.converged) << report.message;
    const ActuatorReading cable = simulation.actuator_state(0);
    const std::vector<Eigen::Vector3d>& path_m = cable.path_m;
    const std::size_t last = path_m.size() - 1;
    ASSERT_GT(last, 20u);
    const double angle =
        std::acos((path_m[1] - path_m[0]).normalized().dot((path_m[last] - path_m[last - 1]).normalized()));
    EXPECT_GT(angle, 0.8);
    ASSERT_EQ(cable.span_tensions_n.size(), 2u);
    EXPECT_GT(cable.span_tensions_n[1], 0.02);
    EXPECT_NEAR(cable.span_tensions_n[0] / cable.span_tensions_n[1], std::exp(mu * angle), 0.01) << mu;
    for (const Eigen::Vector3d& at : path_m)
      EXPECT_GT((at - kPost_m).cross(kPostAlong_m.normalized()).norm(), kPostRadius_m - 1e-9);
    const Eigen::Vector3d before_m = simulation.marker_position(0);
    Eigen::MatrixXd slope = simulation.marker_sensitivities();
    constexpr double kMore = 3e-4;
    simulation.set_command("cable", 0.97 - kMore);
    ASSERT_TRUE(simulation.solve_equilibrium().converged);
    const Eigen::Vector3d moved = (simulation.marker_position(0) - before_m) / -kMore;
    EXPECT_LT((moved - slope.col(0)).norm(), 1e-3 * moved.norm()) << moved.transpose() << " / " << slope.transpose();
  }
}

// Where it does not touch it is the straight cable, to the last digits.
TEST(CableAround, IsStraightWhereNothingIsInItsWay) {
  const std::string below = "drive_points_m: [[-0.02, 0.025, 0.004]], model: sliding, " + kPlug;
  Simulation far = bar_with(below + ", around: [post]", bar_below_post()), straight = bar_with(below, bar_below_post());
  for (Simulation* simulation : {&far, &straight}) {
    simulation->set_command("cable", 0.98);
    ASSERT_TRUE(simulation->solve_equilibrium().converged);
  }
  EXPECT_LT((far.state().positions_m - straight.state().positions_m).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(CableAround, MovesInTimeAndKeepsAccountOfItsFriction) {
  Simulation simulation = bar_with(kOverPost + ", model: friction, friction_coefficient: 0.4", bar_below_post());
  simulation.keep_energy_ledger();
  for (int i = 0; i < 40; ++i) {
    simulation.set_command("cable", 1.0 - 0.03 * std::sin(0.1 * i));
    const SolveReport report = simulation.step();
    ASSERT_TRUE(report.converged) << report.message << " in step " << i;
  }
  const EnergyLedger& ledger = *simulation.energy_ledger();
  EXPECT_NEAR(ledger.closure_error_j, 0.0, 0.01 * ledger.turned_over_j);
}

std::string refusal(const std::string& settings, Body body) {
  try {
    bar_with(settings, std::move(body));
  } catch (const SettingsError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(CableAround, IsRefusedWithPlaceAndReason) {
  const auto expect = [](const std::string& settings, const std::string& part) {
    const std::string message = refusal(settings, bar_below_post());
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  const std::string drive = "drive_points_m: [[-0.02, 0.025, 0.004]], ";
  expect(drive + kPlug + ", around: [pole]", "around[0]: unknown obstacle 'pole'; known: post");
  expect(drive + kPlug + ", around: [post], model: springs, stiffness_n_m: 1000", "around: model springs knows no");
  expect(drive + kPlug + ", model: friction, friction_coefficient: 0.1, friction_on_obstacles: 0.2",
         "friction_on_obstacles: is of obstacles; list them as around");
  expect("drive_points_m: [[0.05, 0.035, 0]], " + kPlug + ", around: [post]", "0.01 m inside obstacle 'post'");
  expect("points_m: [[0, 0, 0], [0.09, 0, 0]], around: [post]", "around: the cable is nowhere in the air");
  Body moving = held_bar();
  moving.set_obstacles({{"post", Sphere{kPost_m, 0.01}, {{0.0}, {1.0, {0, 0.01, 0}}}, 0.0}});
  EXPECT_NE(refusal(drive + kPlug + ", around: [post]", std::move(moving)).find("obstacle 'post' moves"),
            std::string::npos);
}

TEST(DrivePoints, AreRefusedWithPlaceAndReason) {
  Body loose(box_mesh({0, -0.01, -0.01}, {0.1, 0.01, 0.01}, {5, 2, 2}), Material{264200.0, 0.4, 1070.0});
  EXPECT_NE(refusal(kDrivePoints + kPlug, std::move(loose)).find("drive_points_m[0]: stands on the frame"),
            std::string::npos);
  EXPECT_NE(
      refusal("drive_points_m: [[0, 0.05]], " + kPlug, held_bar()).find("drive_points_m[0]: a point is [x, y, z]"),
      std::string::npos);
  EXPECT_NE(refusal("drive_points_m: [[0, 0.05, 0], [0, 0.05, 0]], " + kPlug, held_bar())
                .find("drive_points_m[1]: repeats the point before it"),
            std::string::npos);
  EXPECT_NE(refusal("drive_points_m: [[0.095, 0, 0]], " + kPlug, held_bar())
                .find("drive_points_m[0]: repeats the point beside it"),
            std::string::npos);
  EXPECT_NE(refusal(kPlug, held_bar()).find("points_m: a cable needs at least two points"), std::string::npos);
}

}  // namespace
}  // namespace soft_robot_lab
