// SPDX-License-Identifier: BSD-3-Clause
// The rig's experiments, made shorter.
#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "study/rig/rig_experiments.h"

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;

class RigExperiments : public testing::Test {
 protected:
  RigExperiments() : folder_(fs::path(testing::TempDir()) / "rig_experiments_test") {
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "experiments");
    for (const std::string part : {"motors", "robots"})
      fs::copy(std::string(SOFT_ROBOT_LAB_SOURCE "/config/") + part, folder_ / part, fs::copy_options::recursive);
  }
  ~RigExperiments() override { fs::remove_all(folder_); }

  ExperimentResult run(const std::string& name, const std::string& settings) {
    std::ofstream(folder_ / "experiments" / (name + ".yaml")) << settings;
    ExperimentContext context;
    context.config_folder = folder_;
    context.output_folder = folder_;
    for (const Experiment& experiment : rig_experiments()) {
      if (experiment.name == name) return experiment.run(context);
    }
    throw std::invalid_argument(name);
  }

  fs::path folder_;
};

// The L6470 drives 21 units of 15.26 steps/s, 49.93 ms a mm, and speeds up and slows down for 20.0 ms in all; the line
// and the board's rounds take up to 10 ms more. The source's 50.4 ms and 19.9 ms lie 1 % and 10 ms from that.
TEST_F(RigExperiments, PullsAsFastAsSpeedAndAccelerationAllow) {
  const ExperimentResult result =
      run("4.3.1", "{rig: motors/long_cable.yaml, pulls_mm: [10, 20, 60, 120], repeats: 2, fit_from_mm: 20}");
  EXPECT_NEAR(result.numbers["fit"]["slope_ms_per_mm"], 1e3 / (21 * 15.2588 * 0.0625), 0.03);
  EXPECT_GT(result.numbers["fit"]["offset_ms"], 20.0);
  EXPECT_LT(result.numbers["fit"]["offset_ms"], 30.0);
  EXPECT_LT(result.numbers["worst_relative_error"], 0.02);
  for (const double sd_ms : result.numbers["sd_ms"]) EXPECT_LT(sd_ms, 5.0);
  result.plots.at(0).validate();
}

TEST_F(RigExperiments, PullsInTheSourcesRoundsAndFitsFromWhereItIsAsked) {
  std::ofstream(folder_ / "motors" / "slow.yaml")
      << "{device: /dev/rig, drive: {acceleration_steps_s2: 1000, deceleration_steps_s2: 1000}, motors: [{name: cable, "
         "cable: {rest_length_m: 0.25, min_contraction: 0.19, max_contraction: 1.0}}]}";
  const ExperimentResult result =
      run("4.3.1", "{rig: motors/slow.yaml, pulls_mm: [2, 20, 40], repeats: 2, fit_from_mm: 20}");
  std::vector<double> order_mm;
  for (const auto& pull : result.numbers["in_order"]) order_mm.push_back(pull[0]);
  EXPECT_EQ(order_mm, (std::vector<double>{2, 20, 40, 2, 20, 40}));
  // Twenty times the time to speed up. 2 mm do not reach the top speed: they take longer than the line says, and would
  // tilt it.
  EXPECT_NEAR(result.numbers["fit"]["offset_ms"], 325.0, 10.0);
  EXPECT_NEAR(result.numbers["fit"]["slope_ms_per_mm"], 49.93, 0.3);
  EXPECT_NEAR(result.numbers["mean_ms"][0], 2e3 * std::sqrt(32.0 / 1000.0), 15.0);
}

// Of Hammerbot pulled by both cables cameras may see no marker of its shape.
TEST_F(RigExperiments, DrawsShapesWhoseMarkersAreHidden) {
  for (const std::string part : {"cameras", "materials"})
    fs::copy(std::string(SOFT_ROBOT_LAB_SOURCE "/config/") + part, folder_ / part, fs::copy_options::recursive);
  std::ofstream(folder_ / "robots" / "hammerbot" / "seen_from_behind.yaml")
      << "include: robot.yaml\nbody: {element_size_m: 0.03}\n"
         "markers: [{name: behind, position_m: [0, 0.010, -0.050]}, {name: tip, position_m: [0, 0, -0.100]}]\n";
  std::ofstream(folder_ / "robots" / "hammerbot" / "other.yaml") << "robot: {include: seen_from_behind.yaml}\n";
  const ExperimentResult result =
      run("6.4.1",
          "{robot: robots/hammerbot/seen_from_behind.yaml, plant: robots/hammerbot/other.yaml, "
          "rig: robots/hammerbot/motors.yaml, cameras: cameras/box.yaml, tracker: robots/hammerbot/tracker.yaml, "
          "balls: robots/hammerbot/balls.yaml, frames: 1, configurations: [{name: a, contractions: [1, 1]}], "
          "come_back: [a, a], shape: [behind]}");
  for (const Plot& plot : result.plots) plot.validate();
}

// Coarse, short, and with markers that need no cameras.
TEST_F(RigExperiments, DrawsAPathBetterWithFeedback) {
  for (const std::string part : {"cameras", "materials"})
    fs::copy(std::string(SOFT_ROBOT_LAB_SOURCE "/config/") + part, folder_ / part, fs::copy_options::recursive);
  std::ofstream(folder_ / "robots" / "hammerbot" / "stiffer.yaml")
      << "robot: {include: robot.yaml, body: {element_size_m: 0.03, material: {stiffness_ratio: 1.3}}, cables: {left: "
         "{pull_speed_m_s: 0, length_offset_m: 0.0005}, right: {pull_speed_m_s: 0}}}\n";
  std::ofstream(folder_ / "line.yaml")
      << "{marker: tip, plane: {center_m: [0, 0, -0.0985], across: [1, 0, 0], up: [0, 0, 1]}, "
         "curve: {polyline_m: [[-0.003, 0], [0.003, 0.0005]]}, tolerance_m: 0.0005, duration_s: 4, samples: 12}\n";
  const ExperimentResult result = run(
      "paths",
      "{frame_rate_hz: 28, delay_s: 0.08, noise_m: 2.0e-5, gain: 0.2, drive_lag_s: 0.05, learning_gain: 0.5, "
      "learning_smoothing: 1, reserve: 0.2, rounds: 1, model_rounds: 1, rest_states: 3, robots: [{name: Hammerbot, "
      "robot: robots/hammerbot/robot.yaml, plant: robots/hammerbot/stiffer.yaml, rig: robots/hammerbot/motors.yaml, "
      "cameras: cameras/box.yaml, tracker: robots/hammerbot/tracker.yaml, balls: robots/hammerbot/balls.yaml, "
      "frames: 1, fitted: false, overrides: {body: {element_size_m: 0.03}}, "
      "paths: [{name: line, task: line.yaml, fastest: false}]}]}");
  EXPECT_TRUE(result.converged) << result.message;
  ASSERT_EQ(result.numbers["paths"].size(), 1u);
  const auto& path = result.numbers["paths"][0];
  EXPECT_LT(path["unreachable_m"].get<double>(), 3e-4);
  EXPECT_GT(path["open_loop_rms_m"].get<double>(), 2e-4);
  EXPECT_LT(path["feedback_rms_m"].get<double>(), 0.7 * path["open_loop_rms_m"].get<double>());
  EXPECT_LT(path["learnt_rms_m"].get<double>(), path["feedback_rms_m"].get<double>());
  for (const Plot& plot : result.plots) plot.validate();
}

TEST_F(RigExperiments, CountsWhatFaultsDo) {
  const ExperimentResult result = run(
      "rig_faults",
      "{rig: robots/hammerbot/motors.yaml, commands: 200, corrupted: 0.02, lost: 0, doubled: 0, unplugs: 1, resets: 1, "
      "brown_outs: 0, seed: 2}");
  EXPECT_TRUE(result.converged) << result.message;
  EXPECT_EQ(result.numbers["commands"], 200);
  EXPECT_EQ(result.numbers["unplugs"], 1);
  EXPECT_EQ(result.numbers["resets"], 1);
  EXPECT_GT(result.numbers["corrupted"], 0);
  EXPECT_EQ(result.numbers["lost"], 0);
  EXPECT_EQ(result.numbers["doubled"], 0);
  EXPECT_EQ(result.numbers["wrong_unflagged"], 0);
  EXPECT_EQ(result.numbers["unaccounted"], 0);
  EXPECT_EQ(result.numbers["unknown_declared"], 0);
  result.plots.at(0).validate();
}

TEST_F(RigExperiments, RefuseBadSettings) {
  EXPECT_ANY_THROW(run("4.3.1", "{rig: motors/long_cable.yaml, pulls_mm: [10], repeats: 0, fit_from_mm: 20}"));
  EXPECT_ANY_THROW(run("4.3.1", "{rig: motors/nowhere.yaml, pulls_mm: [10], repeats: 1, fit_from_mm: 20}"));
}

}  // namespace
}  // namespace soft_robot_lab
