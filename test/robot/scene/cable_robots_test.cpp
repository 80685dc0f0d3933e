// SPDX-License-Identifier: BSD-3-Clause
// The robots with cables that the package brings along, in time.
#include <string>

#include <gtest/gtest.h>

#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/robot/scene/scene.h"
#include "settings/overrides_from.h"

namespace soft_robot_lab {
namespace {

// Its first cable pulls by a fifth, as fast as the drive can, which takes all that time.
void expect_easy_pull(const std::string& robot, double duration_s, int iterations_a_step) {
  SCOPED_TRACE(robot);
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  const Scene scene = load_scene(SOFT_ROBOT_LAB_SOURCE "/config/robots/" + robot + "/robot.yaml", options);
  Simulation& simulation = *scene.simulation;
  const Actuator& cable = *simulation.actuators().front();
  simulation.set_command(cable.name(), 0.8);
  const int steps = static_cast<int>(duration_s / simulation.options().time_step_s);
  int iterations = 0;
  for (int i = 0; i < steps; ++i) {
    const SolveReport report = simulation.step();
    EXPECT_TRUE(report.converged) << i << ": " << report.message;
    EXPECT_EQ(report.inverted_elements, 0) << i << ": " << report.message;
    iterations += report.iterations;
  }
  EXPECT_DOUBLE_EQ(simulation.state().drives[0].actuated_command, 0.8);
  EXPECT_LE(iterations, iterations_a_step * steps);
}

TEST(CableRobots, TakeAFifthOfTheirLengthInFewIterations) {
  expect_easy_pull("hanging_bar", 1.4, 2);
  expect_easy_pull("spinebot", 0.9, 3);
  expect_easy_pull("hammerbot", 1.1, 3);
  expect_easy_pull("gripper", 1.1, 3);
  expect_easy_pull("finger_a1", 0.9, 3);
  expect_easy_pull("finger_a2", 1.3, 3);
}

Scene touching(const std::string& robot) {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  options.overrides = overrides_from("contact: {self: true}");
  return load_scene(SOFT_ROBOT_LAB_SOURCE "/config/robots/" + robot + "/robot.yaml", options);
}

// Where the matrix of a step does not serve, half the step does: the way down the energy took up to seconds. What
// touches changes nearly every step, and took a new factor each time.
TEST(CableRobots, SpinebotsVertebraeMeetByFewFactorsAndNoWayDownTheEnergy) {
  const Scene scene = touching("spinebot");
  Simulation& simulation = *scene.simulation;
  for (const char* cable : {"left", "right"}) simulation.set_command(cable, 0.8);
  int factorisations = 0;
  for (int i = 0; i < 54; ++i) {
    const SolveReport report = simulation.step();
    EXPECT_TRUE(report.converged) << i << ": " << report.message;
    EXPECT_EQ(report.inverted_elements, 0) << i;
    for (const SolvePathStage& stage : report.path) EXPECT_NE(stage.stage, SolveStage::energy_descent) << i;
    factorisations += report.factorisations;
  }
  EXPECT_LE(factorisations, 27) << "half of the steps";
  EXPECT_GT(simulation.contacts().front().normal_force_n, 1.0);
  EXPECT_LT(simulation.contacts().front().largest_penetration_m, 1e-4);
}

// Past the shape that buckles it falls at that shape's commands; with the whole pull it folded its beam within two
// elements, and then found nothing in 42 s.
TEST(CableRobots, HammerbotBucklesAndDoesNotFoldWhereBothCablesPull) {
  const Scene scene = touching("hammerbot");
  Simulation& simulation = *scene.simulation;
  for (const char* cable : {"left", "right"}) simulation.set_command(cable, 0.6);
  const SolveReport report = simulation.solve_equilibrium();
  EXPECT_TRUE(report.converged) << report.message;
  EXPECT_EQ(report.inverted_elements, 0);
  EXPECT_LT(report.iterations, 300);
  EXPECT_EQ(simulation.contacts().front().area_m2, 0.0);  // pulled in time it comes to the same rest, likewise
}

// The corners of Spinebot's cable alone give the points that its file has by hand, and one more, where the cable enters
// the vertebra of its plug.
TEST(CableRobots, SpinebotsCableFindsItsWayByItself) {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  const std::string file = SOFT_ROBOT_LAB_SOURCE "/config/robots/spinebot/robot.yaml";
  const auto left = [](const Scene& scene) { return scene.simulation->actuator_state(0).path_m; };
  std::vector<Eigen::Vector3d> wanted = left(load_scene(file, options));
  wanted.insert(wanted.end() - 1, Eigen::Vector3d(-0.011, 0, -0.078));
  options.overrides = overrides_from(
      "cables: [{name: left, path_m: [[-0.011, 0, 0], [-0.011, 0, -0.0805]], via_points: given, plug_radius_m: "
      "0.0025}]");
  const std::vector<Eigen::Vector3d> found = left(load_scene(file, options));
  ASSERT_EQ(found.size(), wanted.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_LT((found[i] - wanted[i]).norm(), 1e-9) << i;
}

}  // namespace
}  // namespace soft_robot_lab
