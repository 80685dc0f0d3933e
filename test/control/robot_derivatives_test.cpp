// SPDX-License-Identifier: BSD-3-Clause
// What the methods know of the package's own robots: derivatives by implicit differentiation beside central
// differences of the equilibria.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/control/find_policy.h"
#include "soft_robot_lab/control/forward_model.h"
#include "soft_robot_lab/robot/scene/scene.h"
#include "settings/overrides_from.h"

namespace soft_robot_lab {
namespace {

struct Case {
  std::string name, robot, marker;
  Eigen::VectorXd commands;
  std::string overrides = {};  // of the scene
};

// The robot has syringes.
const std::string kBubblebotByGas = "\nchambers: {a: {command: beta}, b: {command: beta}, c: {command: beta}}";

void PrintTo(const Case& it, std::ostream* os) { *os << it.name; }

Eigen::VectorXd vector(std::initializer_list<double> values) {
  return Eigen::Map<const Eigen::VectorXd>(values.begin(), static_cast<Eigen::Index>(values.size()));
}

class RobotDerivatives : public testing::TestWithParam<Case> {};

TEST_P(RobotDerivatives, AreThoseOfTheEquilibria) {
  const Case& it = GetParam();
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  options.overrides = overrides_from("solver: {tolerance: 1.0e-9}" + it.overrides);
  const Scene scene = load_scene(SOFT_ROBOT_LAB_SOURCE "/config/robots/" + it.robot + "/robot.yaml", options);
  std::vector<std::string> names;
  for (const auto& actuator : scene.simulation->actuators()) names.push_back(actuator->name());
  ForwardModel model(*scene.simulation, {it.marker}, names);
  const Prediction here = model.predict(it.commands, true);
  ASSERT_EQ(here.marker_jacobian.cols(), it.commands.size());
  EXPECT_GT(here.marker_jacobian.norm(), 1e-3);  // [m per command]: there is something to compare
  constexpr double step = 1e-4;
  Eigen::MatrixXd markers(3, it.commands.size()), tensions(it.commands.size(), it.commands.size());
  for (Eigen::Index i = 0; i < it.commands.size(); ++i) {
    const Eigen::VectorXd moved = step * Eigen::VectorXd::Unit(it.commands.size(), i);
    const Prediction there = model.predict(it.commands + moved, false);
    const Prediction back = model.predict(it.commands - moved, false);
    markers.col(i) = (there.markers_m - back.markers_m) / (2 * step);
    tensions.col(i) = (there.tensions_n - back.tensions_n) / (2 * step);
  }
  EXPECT_LT((here.marker_jacobian - markers).norm(), 1e-3 * markers.norm());
  EXPECT_LE((here.tension_jacobian - tensions).norm(), 1e-3 * tensions.norm());
}

INSTANTIATE_TEST_SUITE_P(, RobotDerivatives,
                         testing::Values(Case{"SpinebotBent", "spinebot", "tip", vector({0.85, 0.97})},
                                         Case{"SpinebotOneCableSlack", "spinebot", "tip", vector({0.8, 1.1})},
                                         Case{"HammerbotBent", "hammerbot", "tip", vector({0.9, 1.0})},
                                         Case{"HammerbotBeforeItBuckles", "hammerbot", "tip", vector({0.84, 1.0})},
                                         Case{"CuboidInflated", "hollow_cuboid", "skin_x", vector({1.3})},
                                         Case{"BubblefingerBent", "bubblefinger", "tip", vector({1.2}),
                                              "\nchambers: {main: {command: beta}}"},
                                         Case{"BubblebotBent", "bubblebot", "tip", vector({1.4, 1.15, 1.0}),
                                              kBubblebotByGas}),
                         [](const auto& test) { return test.param.name; });

// Air: three amounts of gas bring a marker anywhere within reach, where the optimiser knows nothing but derivatives.
TEST(Bubblebot, IsBroughtToAPlaceByTheGasInItsThreeChambers) {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  options.overrides = overrides_from(kBubblebotByGas);
  const Scene scene = load_scene(SOFT_ROBOT_LAB_SOURCE "/config/robots/bubblebot/robot.yaml", options);
  Simulation& simulation = *scene.simulation;
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  const SimulationState hanging = simulation.state();
  const Eigen::Vector3d betas = vector({1.6, 1.25, 1.05});
  const Eigen::Vector3d position_m = ForwardModel(simulation, {"tip"}, {"a", "b", "c"}).predict(betas, false).markers_m;
  simulation.set_state(hanging);
  const PolicyAnswer answer = find_policy(simulation, {{{{{"tip", position_m, 1.0}}, 2.0, {}}}, {}, 0.0}, {});
  ASSERT_TRUE(answer.success);
  const OptimisationSummary& summary = answer.summaries.front();
  EXPECT_GT(summary.initial_distance_m, 1e-3);
  EXPECT_TRUE(summary.target_reached) << summary.final_distance_m << " " << summary.stop_reason;
  EXPECT_LT((summary.commands - betas).norm(), 0.02) << summary.commands.transpose();
  EXPECT_LE(summary.evaluations, 40);
}

}  // namespace
}  // namespace soft_robot_lab
