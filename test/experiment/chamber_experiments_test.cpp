// The experiments with air chambers, on coarser meshes and with fewer steps than config/experiments has them.
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "scene/scene_files.h"
#include "soft_robot_lab/experiment/experiment.h"

namespace soft_robot_lab {
namespace {

// The robots have syringes.
const std::string kFingerByGas = "scene: {chambers: {main: {command: beta}}}\n";
const std::string kBotByGas = "scene: {chambers: {a: {command: beta}, b: {command: beta}, c: {command: beta}}}\n";

class ChamberExperiments : public testing::Test {
 protected:
  ChamberExperiments() {
    std::filesystem::create_directory_symlink(SOFT_ROBOT_LAB_SOURCE "/config/reference", folder_.path("reference"));
  }

  // A robot's mesh at two sizes.
  ExperimentResult run(const std::string& name, const std::string& robot, const std::string& coarse_m,
                       const std::string& fine_m, const std::string& settings) {
    const std::string include =
        "include: " SOFT_ROBOT_LAB_SOURCE "/config/robots/" + robot + ".yaml\nbody: {element_size_m: ";
    folder_.write("coarse.yaml", include + coarse_m + "}\n");
    folder_.write("fine.yaml", include + fine_m + "}\n");
    folder_.write("experiments/" + name + ".yaml", "meshes: {coarse: coarse.yaml, fine: fine.yaml}\n" + settings);
    ExperimentContext context;
    context.config_folder = folder_.path("");
    context.mesher = SOFT_ROBOT_LAB_MESHER;
    for (const Experiment& experiment : simulation_experiments())
      if (experiment.name == name) return experiment.run(context);
    throw std::logic_error("no experiment " + name);
  }

  static void expect_sound(const ExperimentResult& result) {
    EXPECT_TRUE(result.converged) << result.message;  // which tells of inverted elements too
    EXPECT_LT(result.numbers["gas_residual"].get<double>(), 1e-6);
    for (const Plot& plot : result.plots) EXPECT_NO_THROW(plot.validate()) << plot.name;
  }

  SceneFolder folder_;
};

TEST_F(ChamberExperiments, TheCuboidsPressureComesNearTheReferenceWithFinerElements) {
  for (const std::string name : {"5.3.1", "5.3.2"}) {
    const ExperimentResult result =
        run(name, "hollow_cuboid", "0.02", "0.012", name == "5.3.1" ? "betas: [1.1]\n" : "betas: [0.975]\n");
    expect_sound(result);
    ASSERT_EQ(result.table.rows.size(), 2u);
    const double coarse = result.numbers["worst_pressure_error"]["coarse"];
    const double fine = result.numbers["worst_pressure_error"]["fine"];
    EXPECT_LT(fine, 0.03);
    EXPECT_GT(fine, 0.0);
    EXPECT_LT(fine, coarse);
  }
}

TEST_F(ChamberExperiments, BubblefingerBendsAwayFromItsWedgesOnEveryMesh) {
  const ExperimentResult result =
      run("6.3.4", "bubblefinger", "0.014", "0.010", kFingerByGas + "betas: [1, 1.75, 2.57]\n");
  expect_sound(result);
  EXPECT_LT(result.numbers["tip_difference"].get<double>(), 0.03);
  EXPECT_GT(result.numbers["bends_down_m"]["coarse"].get<double>(), 0.02);
  EXPECT_GT(result.numbers["bends_down_m"]["fine"].get<double>(), 0.02);
}

TEST_F(ChamberExperiments, BubblebotStretchesOnTheInflatedSideAndBendsAwayFromIt) {
  for (const std::string chamber : {"a", "c"}) {
    SCOPED_TRACE(chamber);
    const ExperimentResult result =
        run("6.3.5", "bubblebot", "0.03", "0.02", kBotByGas + "chamber: " + chamber + "\nbetas: [1, 2.5, 5]\n");
    expect_sound(result);
    EXPECT_LT(result.numbers["tip_difference"].get<double>(), 0.03);
    for (const std::string mesh : {"coarse", "fine"}) {
      EXPECT_GT(result.numbers["bends_away_m"][mesh].get<double>(), 0.01);
      EXPECT_GT(result.numbers["stretches_m"][mesh].get<double>(), 0.015);
    }
  }
}

TEST_F(ChamberExperiments, RefuseSettingsThatMakeNoSense) {
  EXPECT_THROW(run("6.3.4", "bubblefinger", "0.03", "0.03", kFingerByGas + "betas: []\n"), std::exception);
  EXPECT_THROW(run("6.3.4", "bubblefinger", "0.03", "0.03", kFingerByGas + "betas: [1, 9]\n"), std::invalid_argument);
  EXPECT_THROW(run("6.3.5", "bubblebot", "0.03", "0.03", kBotByGas + "chamber: d\nbetas: [1]\n"),
               std::invalid_argument);
}

}  // namespace
}  // namespace soft_robot_lab
