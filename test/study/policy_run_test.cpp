// SPDX-License-Identifier: BSD-3-Clause
#include "study/experiments/policy_run.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "soft_robot_lab/mechanics/actuators/factory.h"

namespace soft_robot_lab {
namespace {

PolicyRun run_through(std::vector<double> distance_m) {
  PolicyRun run;
  run.distance_m = std::move(distance_m);
  for (size_t i = 0; i < run.distance_m.size(); ++i) run.cpu_s.push_back(0.1 * static_cast<double>(i + 1));
  return run;
}

TEST(PolicyRun, TellsHowItSwings) {
  const PolicyRun swinging = run_through({0.06, 0.05, 0.09, 0.04, 0.07, 0.0700001, 0.03});
  EXPECT_EQ(swinging.turns(), 4);
  EXPECT_DOUBLE_EQ(swinging.largest_rise_m(), 0.04);
  const PolicyRun steady = run_through({0.06, 0.05, 0.0500005, 0.04});  // half a micrometre is no turn
  EXPECT_EQ(steady.turns(), 0);
  EXPECT_LT(steady.largest_rise_m(), 1e-6);
}

TEST(PolicyRun, KnowsWhenItWasAsNear) {
  const PolicyRun run = run_through({0.06, 0.02, 0.03, 0.01});
  EXPECT_DOUBLE_EQ(run.cpu_until_s(0.025).value(), 0.2);
  EXPECT_DOUBLE_EQ(run.cpu_until_s(0.01).value(), 0.4);
  EXPECT_FALSE(run.cpu_until_s(0.009).has_value());
}

TEST(PolicyRun, TellsBetweenWhatItSwingsInTheEnd) {
  const PolicyRun run = run_through({0.09, 0.01, 0.03, 0.02, 0.04, 0.03});
  EXPECT_DOUBLE_EQ(run.least_from_m(3), 0.02);
  EXPECT_DOUBLE_EQ(run.most_from_m(3), 0.04);
  EXPECT_DOUBLE_EQ(run.last_m(), 0.03);
  EXPECT_DOUBLE_EQ(run.least_from_m(7), 0.03);  // it never came so far
  PolicyRun none;
  none.summary.initial_distance_m = 0.05;
  EXPECT_DOUBLE_EQ(none.last_m(), 0.05);
  EXPECT_DOUBLE_EQ(none.most_from_m(10), 0.05);
}

const std::string kConfig = SOFT_ROBOT_LAB_SOURCE "/config";

MethodSettings settings_of(const std::string& experiment) {
  return read_method_settings(YamlNode::load_file(kConfig + "/experiments/" + experiment + ".yaml"), kConfig);
}

TEST(ReachTargets, AreTheSameTenForDescentAndPid) {
  const ReachTargets descent = settings_of("7.3.1").reach, pid = settings_of("7.3.2").reach;
  ASSERT_EQ(descent.targets.size(), 10u);
  ASSERT_EQ(pid.targets.size(), 10u);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(descent.targets[i].position_m, pid.targets[i].position_m);
}

TEST(ReachTargets, LieInTheCablesPlaneNearTheLowerHalfAndAwayFromTheCentre) {
  const ReachTargets reach = settings_of("7.3.1").reach;
  EXPECT_EQ(reach.marker, "tip");
  for (const ReachTarget& target : reach.targets) {
    EXPECT_EQ(target.position_m.y(), 0.0);
    EXPECT_GE((target.position_m - Eigen::Vector3d(0.0, 0.0, -0.05)).norm(), 0.025);
    EXPECT_LE(target.position_m.z(), -0.05);
    EXPECT_GE(target.position_m.z(), -0.1);
  }
}

TEST(ReachTargets, GiveTheSourcesGradientToleranceWhichIsNoDefault) {
  for (const OptimiserOptions& options : settings_of("7.3.1").methods)
    EXPECT_EQ(options.gradient_tolerance_m2, 1e-4) << options.method;
  EXPECT_EQ(OptimiserOptions().gradient_tolerance_m2, 0.0);
}

// The two distances that the source prints: 60 mm from the middle of Spinebot's 98.5 mm, 38.15 mm from the tip at the
// start.
TEST(SourceBall, IsAsFarFromTheRobotsMiddleAndFromItsTipAsTheSourceHasIt) {
  const YamlNode node = YamlNode::load_file(kConfig + "/experiments/7.3.3.yaml");
  const Eigen::Vector3d ball_m = node.vector3("target_m");
  EXPECT_NEAR((ball_m - Eigen::Vector3d(0.0, 0.0, -0.04925)).norm(), 0.060, 1e-5);
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  const Scene scene = load_scene(kConfig + "/" + node.text("robot"), options);
  ASSERT_TRUE(scene.simulation->solve_equilibrium().converged);
  const Eigen::Vector3d tip_m = scene.simulation->marker_position(scene.simulation->marker_index(node.text("marker")));
  EXPECT_NEAR((ball_m - tip_m).norm(), 0.03815, 1e-4);
  const std::vector<OptimiserOptions> methods = read_methods(node);
  EXPECT_EQ(methods.front().method, "rmsprop");  // whose policy is played
  EXPECT_EQ(methods.front().gradient_tolerance_m2, 1e-6);
  EXPECT_EQ(methods.front().max_iterations, 1000);
}

TEST(ReachTargets, RefuseABoxWithoutAnyPlace) {
  const std::string file = testing::TempDir() + "/targets.yaml";
  const auto refused = [&](const std::string& box) {
    std::ofstream(file) << "{robot: r.yaml, marker: tip, count: 1, seed: 1, center_m: [0, 0, 0], " << box << "}";
    try {
      read_reach_targets(file, kConfig);
    } catch (const SettingsError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_NE(refused("min_m: [0, 0, 0], max_m: [0.1, 0, 0], from_center_m: 0.1").find("no such places"),
            std::string::npos);
  EXPECT_NE(
      refused("min_m: [0, 0.1, 0], max_m: [0.1, 0, 0], from_center_m: 0.05").find("min_m must not be above max_m"),
      std::string::npos);
}

}  // namespace
}  // namespace soft_robot_lab
