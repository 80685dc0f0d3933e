// SPDX-License-Identifier: BSD-3-Clause
// Fitting creep, on a lying bar that creeps while its commands are held.
#include <gtest/gtest.h>

#include "control/identification/creep_model.h"
#include "control/identification/drive_play.h"
#include "control/identification/fit_statistics.h"
#include "control/identification/simulated_now.h"
#include "fitted_bar.h"

namespace soft_robot_lab {
namespace {

constexpr double kHeld_s = 6.0, kWindow_s = 0.5, kStep_s = 0.1;
using Holds = std::vector<std::pair<double, double>>;
const Holds kHolds = {{0.9, 1.1}, {1.1, 0.92}, {0.95, 1.1}};

// Linear elements are quick, and truth and model are of the same ones.
const std::string kBar = kLying + "body: {element: linear}\n";

SceneOptions creeping_bar(double stiffness_ratio, double relaxation_time_s) {
  return options_with(kLying + "solver: {time_step_s: 0.1}\nbody: {element: linear, hysteresis: {stiffness_ratio: " +
                      std::to_string(stiffness_ratio) + ", relaxation_time_s: " + std::to_string(relaxation_time_s) +
                      "}}\n");
}

// What cameras see in windows, while each command is held; finer in time than any fit simulates it.
std::vector<MeasuredPose> watch(const SceneOptions& options, const Holds& holds,
                                const std::map<std::string, double>& backlash_m = {}, unsigned seed = 1) {
  constexpr double noise_m = 1e-5;
  const Scene scene = load_scene(kScene, options);
  Simulation& bar = *scene.simulation;
  EXPECT_TRUE(bar.solve_equilibrium().converged);
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, noise_m);
  DrivePlay play(bar, backlash_m);
  play.go({1.0, 1.0});
  const auto seen = [&] {
    std::vector<MeasuredMarker> markers;
    for (int m = 0; m < 2; ++m)
      markers.push_back({bar.markers()[static_cast<std::size_t>(m)].name(),
                         bar.marker_position(m) + Eigen::Vector3d::NullaryExpr([&](int) { return normal(random); }),
                         noise_m * noise_m * Eigen::Matrix3d::Identity()});
    return markers;
  };
  std::vector<MeasuredPose> poses;
  for (const auto& [left, right] : holds) {
    const std::vector<double> behind_play = play.go({left, right}).commands;
    bar.set_command("left", behind_play[0]);
    bar.set_command("right", behind_play[1]);
    MeasuredPose pose{{{"left", left}, {"right", right}}, {}};
    pose.held_s = kHeld_s;
    for (int step = 1; step * kStep_s <= kHeld_s + 1e-9; ++step) {
      bar.step();
      if (step % 5 == 3) pose.seen.push_back({kStep_s * step, seen()});
    }
    pose.markers = pose.seen.back().markers;  // in the middle of the last window, not quite at rest
    pose.rest_from_s = kHeld_s - kWindow_s;
    poses.push_back(std::move(pose));
  }
  return poses;
}

FitRequest request() {
  FitRequest request;
  request.model_error_m = 2e-5;
  request.parameters = {{"youngs_modulus_pa", 240000.0, {}, {}}, {"creep", {}, {}, {}}};
  return request;
}

TEST(FitCreep, FindsBothNumbersAndTheStiffnessBeside) {
  const FitResult result = fit_model(kScene, options_with(kBar), watch(creeping_bar(0.25, 2.5), kHolds), request());
  EXPECT_TRUE(result.converged) << result.message;
  EXPECT_NEAR(value_of(result, "creep.stiffness_ratio").value, 0.25, 0.05 * 0.25) << summary(result);
  EXPECT_NEAR(value_of(result, "creep.relaxation_time_s").value, 2.5, 0.05 * 2.5) << summary(result);
  EXPECT_NEAR(value_of(result, "youngs_modulus_pa").value, 264200, 0.005 * 264200) << summary(result);
  EXPECT_TRUE(value_of(result, "creep.stiffness_ratio").identifiable);
  EXPECT_TRUE(result.overrides.has({"body", "hysteresis"})) << result.overrides.text();

  FitRequest without = request();
  without.parameters.pop_back();
  const FitResult blind = fit_model(kScene, options_with(kBar), watch(creeping_bar(0.25, 2.5), kHolds), without);
  EXPECT_GT(std::abs(value_of(blind, "youngs_modulus_pa").value - 264200), 0.01 * 264200)
      << "what is left of creep would count as stiffness\n"
      << summary(blind);
  EXPECT_TRUE(warns(blind, "the robot creeps, and intervals are wider by that; hold longer, or fit creep"))
      << summary(blind);
  EXPECT_FALSE(warns(result, "hold longer")) << summary(result);
}

// Where cables rub, creep and swings decide where they hold: fitted after each other, rest states and creep hide errors
// of one another.
TEST(FitCreep, FindsFrictionBacklashAndCreepTogether) {
  const auto rubbing = [](const std::string& friction) {
    const std::string rest = "model: friction, friction_coefficient: " + friction;
    SceneOptions options = creeping_bar(0.25, 2.5);
    options.overrides = overrides_from("cables: [" + cable("left", -0.007, rest) + ", " + cable("right", 0.007, rest) +
                                       "]\n" + options.overrides.text());
    return options;
  };
  FitRequest friction = request();
  friction.parameters.push_back({"friction_coefficient", {}, {}, {}});
  const std::vector<MeasuredPose> poses =
      watch(rubbing("0.3"), {{0.85, 1.1}, {0.9, 1.1}, {0.95, 1.1}, {0.87, 1.1}}, {{"left", 4e-4}});
  friction.parameters.push_back({"backlash_m.left", {}, {}, {}});
  friction.parameters.push_back({"length_offset_m.left", {}, {}, {}});
  const FitResult result = fit_model(kScene, rubbing("0.1"), poses, friction);
  EXPECT_NEAR(value_of(result, "friction_coefficient").value, 0.3, 0.05 * 0.3) << summary(result);
  EXPECT_NEAR(value_of(result, "backlash_m.left").value, 4e-4, 0.05 * 4e-4) << summary(result);
  expect_within(result, "creep.relaxation_time_s", 2.5);  // which friction hides in part
  EXPECT_LT(value_of(result, "creep.relaxation_time_s").deviation, 0.12 * 2.5) << summary(result);
  EXPECT_NEAR(value_of(result, "youngs_modulus_pa").value, 264200, 0.005 * 264200) << summary(result);
}

// Where cables rub, how the robot swung on its way decides where it rests.
TEST(FitCreep, FollowsARobotOnItsWayInTheScenesOwnSteps) {
  const Scene scene = load_scene(kScene, options_with(kBar));
  Simulation& bar = *scene.simulation;
  ASSERT_TRUE(bar.solve_equilibrium().converged);
  bar.set_command("left", 0.95);
  while (bar.state().time_s < 0.3 - 1e-9) bar.step();
  MeasuredPose pose{{{"left", 0.95}}, {}};
  pose.held_s = 0.3;
  const SimulatedHold hold = simulate_holds(kScene, options_with(kBar), {pose}, {}).front();
  EXPECT_NEAR(hold.times_s.back(), 0.3, 1e-9);
  EXPECT_LT((hold.markers_m.back() - places(bar)).norm(), 1e-9);
}

TEST(FitCreep, AsksForLongerHoldsOfASlowRelaxation) {
  const FitResult result = fit_model(kScene, options_with(kBar), watch(creeping_bar(0.25, 12.0), kHolds), request());
  EXPECT_TRUE(
      warns(result, "no command was held for more than 6 s: intervals may exclude the truth; hold longer, for "))
      << summary(result);
}

Holds pulls_of_the_left(int count, unsigned seed) {
  std::mt19937 random(seed);
  Holds holds;
  for (int i = 0; i < count; ++i) holds.emplace_back(0.86 + 0.12 * static_cast<double>(random() % 1000) / 1000.0, 1.1);
  return holds;
}

// Pulled to one side alone, what creeps moves all markers alike, and compliance and length offset with them.
TEST(FitCreep, LeavesTheTruthInIntervalsWhereItIsNotFitted) {
  FitRequest without = request();
  without.parameters = {
      {"youngs_modulus_pa", 240000.0, {}, {}}, {"length_offset_m.left", {}, {}, {}}, {"compliance_m_n", {}, {}, {}}};
  without.model_error_m = 1e-4;
  const std::map<std::string, double> truths = {
      {"youngs_modulus_pa", 264200}, {"length_offset_m.left", 0.0}, {"compliance_m_n", 1e-5}};
  int count = 0, outside = 0;
  for (const int holds : {6, 24})
    for (const double relaxation_s : {2.5, 6.0, 12.0})
      for (const unsigned seed : {1U, 2U}) {
        const FitResult result =
            fit_model(kScene, options_with(kBar),
                      watch(creeping_bar(0.2, relaxation_s), pulls_of_the_left(holds, seed), {}, seed), without);
        for (const auto& [name, truth] : truths) {
          const FittedValue& value = value_of(result, name);
          outside += truth < value.low || truth > value.high ? 1 : 0;
          ++count;
        }
        EXPECT_LT(value_of(result, "youngs_modulus_pa").deviation, 0.05 * 264200) << summary(result);
      }
  EXPECT_EQ(count, 36);
  EXPECT_LE(outside, 2) << "of " << count << ", of 95 % intervals";
}

TEST(FitCreep, HardlyWidensIntervalsWhereNothingCreeps) {
  FitRequest without = request();
  without.parameters.pop_back();
  without.model_error_m = 1e-4;
  std::vector<MeasuredPose> poses =
      watch(options_with(kBar + "solver: {time_step_s: 0.1}\n"), pulls_of_the_left(24, 1));
  const double deviation =
      value_of(fit_model(kScene, options_with(kBar), poses, without), "youngs_modulus_pa").deviation;
  for (MeasuredPose& pose : poses) pose.seen.clear();
  const double of_noise =
      value_of(fit_model(kScene, options_with(kBar), poses, without), "youngs_modulus_pa").deviation;
  EXPECT_GE(deviation, of_noise);
  EXPECT_LT(deviation, 1.2 * of_noise);
}

// Many holds make intervals narrow, and what creeps makes all of them wrong alike.
TEST(FitCreep, WarnsOfManyHoldsThatAreTooShort) {
  Holds many;
  for (int i = 0; i < 24; ++i)
    many.emplace_back(0.88 + 0.005 * ((7 * i) % 24), i % 3 == 0 ? 1.1 : 1.05 - 0.005 * ((5 * i) % 24));
  FitRequest without = request();
  without.parameters.pop_back();
  without.model_error_m = 1e-4;
  for (const double relaxation_s : {2.5, 5.0, 10.0}) {
    const FitResult result =
        fit_model(kScene, options_with(kBar), watch(creeping_bar(0.25, relaxation_s), many), without);
    EXPECT_TRUE(warns(result, "the robot creeps")) << relaxation_s << " s\n" << summary(result);
  }
  const FitResult quick = fit_model(kScene, options_with(kBar), watch(creeping_bar(0.25, 0.5), many), without);
  EXPECT_FALSE(warns(quick, "the robot creeps")) << summary(quick);
}

// Whatever the tracker says of its noise.
TEST(FitCreep, TakesNoNoiseForCreep) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0.0, 2e-4);
  for (const double stated_m : {2e-5, 2e-4, 2e-3})
    for (const int hold_count : {1, 3, 24}) {
      int warnings = 0;
      for (int trial = 0; trial < 100; ++trial) {
        std::vector<MeasuredPose> poses(static_cast<std::size_t>(hold_count));
        for (MeasuredPose& pose : poses) {
          const auto seen = [&] {
            std::vector<MeasuredMarker> markers;
            for (const char* name : {"middle", "tip"})
              markers.push_back({name, Eigen::Vector3d::NullaryExpr([&](int) { return normal(random); }),
                                 stated_m * stated_m * Eigen::Matrix3d::Identity()});
            return markers;
          };
          pose.held_s = 6.0;
          for (int i = 0; i < 12; ++i) pose.seen.push_back({0.25 + 0.5 * i, seen()});
          pose.markers = seen();
        }
        FitResult result;
        warn_of_creep(poses, request(), result);
        warnings += static_cast<int>(result.warnings.size());
      }
      EXPECT_LE(warnings, 1) << hold_count << " holds, stated noise " << stated_m << " m";
    }
}

TEST(FitCreep, SaysWhereHoldsAreTooShortToSeeIt) {
  MeasuredPose pose;
  pose.held_s = 3.5;
  for (const double time_s : {0.55, 1.65, 2.75})
    pose.seen.push_back({time_s, {{"tip", {0, 0, 0}, Eigen::Matrix3d::Identity()}}});
  pose.markers = pose.seen.back().markers;
  FitResult result;
  warn_of_creep({pose, pose}, request(), result);
  EXPECT_TRUE(warns(result, "most commands were held for 3.5 s at most")) << "of frames at 5 Hz";
  EXPECT_TRUE(warns(result, "hold longer, or fit creep"));
  pose.held_s = 0.0;
  FitResult unknown;
  warn_of_creep({pose}, request(), unknown);
  EXPECT_TRUE(unknown.warnings.empty()) << "it is not known how long";
}

TEST(FitCreep, SaysWhereNothingCreeps) {
  const std::vector<MeasuredPose> poses = watch(options_with(kBar + "solver: {time_step_s: 0.1}\n"), {kHolds[0]});
  const FitResult result = fit_model(kScene, options_with(kBar), poses, request());
  EXPECT_FALSE(value_of(result, "creep.stiffness_ratio").identifiable) << summary(result);
  EXPECT_TRUE(warns(result, "cannot identify creep")) << summary(result);
  EXPECT_FALSE(result.overrides.has({"body", "hysteresis"})) << result.overrides.text();
  FitRequest without = request();
  without.parameters.pop_back();
  EXPECT_FALSE(warns(fit_model(kScene, options_with(kBar), poses, without), "creeps"));
}

TEST(FitCreep, RefusesWhatItCannotKnow) {
  std::vector<MeasuredPose> poses = watch(creeping_bar(0.25, 2.5), kHolds);
  const auto refusal = [&](const FitRequest& asked) {
    try {
      fit_model(kScene, options_with(kBar), poses, asked);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("nothing refused");
  };
  FitRequest alone = request();
  alone.parameters.erase(alone.parameters.begin());
  EXPECT_NE(refusal(alone).find("creep is fitted beside others only"), std::string::npos) << refusal(alone);
  FitRequest twice = request();
  twice.parameters.push_back({"creep", {}, {}, {}});
  EXPECT_NE(refusal(twice).find("creep is asked for twice"), std::string::npos) << refusal(twice);
  FitRequest bounded = request();
  bounded.parameters[1].min = 0.1;
  EXPECT_NE(refusal(bounded).find("takes no start and no bounds"), std::string::npos) << refusal(bounded);
  poses[1].held_s = 0.0;
  EXPECT_NE(refusal(request()).find("not known how long"), std::string::npos) << refusal(request());
}

}  // namespace
}  // namespace soft_robot_lab
