// The rig's experiments, made shorter.
#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "soft_robot_lab/rig/rig_experiments.h"

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;

class RigExperiments : public testing::Test {
 protected:
  RigExperiments() : folder_(fs::path(testing::TempDir()) / "rig_experiments_test") {
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "experiments");
    fs::copy(SOFT_ROBOT_LAB_SOURCE "/config/rigs", folder_ / "rigs");
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

TEST_F(RigExperiments, PullsAsFastAsTheThesisMeasured) {
  const ExperimentResult result =
      run("4.3.1", "{rig: rigs/long_cable.yaml, pulls_mm: [10, 20, 60, 200], repeats: 2, fit_from_mm: 20}");
  EXPECT_LT(result.numbers["worst_relative_error"], 0.02);
  EXPECT_NEAR(result.numbers["fit"]["slope_ms_per_mm"], 50.4, 0.03 * 50.4);
  EXPECT_NEAR(result.numbers["fit"]["offset_ms"], 19.9, 20.0);
  EXPECT_EQ(result.numbers["pull_mm"].size(), 4U);
  EXPECT_EQ(result.numbers["mean_ms"].size(), 4U);
  EXPECT_EQ(result.numbers["sd_ms"].size(), 4U);
  result.plots.at(0).validate();
}

TEST_F(RigExperiments, CountsWhatFaultsDo) {
  const ExperimentResult result =
      run("rig_faults",
          "{rig: rigs/hammerbot.yaml, commands: 200, corrupted: 0.02, lost: 0, doubled: 0, unplugs: 1, resets: 1, "
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
  EXPECT_ANY_THROW(run("4.3.1", "{rig: rigs/long_cable.yaml, pulls_mm: [10], repeats: 0, fit_from_mm: 20}"));
  EXPECT_ANY_THROW(run("4.3.1", "{rig: rigs/nowhere.yaml, pulls_mm: [10], repeats: 1, fit_from_mm: 20}"));
}

}  // namespace
}  // namespace soft_robot_lab
