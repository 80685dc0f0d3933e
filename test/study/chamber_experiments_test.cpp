// SPDX-License-Identifier: BSD-3-Clause
// The experiments with air chambers, on coarser meshes and with fewer steps than config/experiments has them.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "reference_table.h"
#include "robot/scene/scene_files.h"
#include "study/experiment.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

// The robots have syringes; the experiments command amounts of gas.
std::string by_gas(const std::string& robot) {
  if (robot == "bubblefinger") return "chambers: {main: {command: beta}}\n";
  if (robot == "bubblebot") return "chambers: {a: {command: beta}, b: {command: beta}, c: {command: beta}}\n";
  return "";
}

class ChamberExperiments : public testing::Test {
 protected:
  ChamberExperiments() {
    std::filesystem::create_directory_symlink(SOFT_ROBOT_LAB_SOURCE "/config/reference", folder_.path("reference"));
  }

  // A robot's mesh at two sizes.
  ExperimentResult run(const std::string& name, const std::string& robot, const std::string& coarse_m,
                       const std::string& fine_m, const std::string& settings) {
    const std::string include =
        "include: " SOFT_ROBOT_LAB_SOURCE "/config/robots/" + robot + "/robot.yaml\nbody: {element_size_m: ";
    folder_.write("coarse.yaml", include + coarse_m + "}\n" + by_gas(robot));
    folder_.write("fine.yaml", include + fine_m + "}\n" + by_gas(robot));
    folder_.write("experiments/" + name + ".yaml", "meshes: {coarse: coarse.yaml, fine: fine.yaml}\n" + settings);
    ExperimentContext context;
    context.config_folder = folder_.path("");
    context.mesher = SOFT_ROBOT_LAB_MESHER;
    for (const Experiment& experiment : simulation_experiments())
      if (experiment.name == name) return experiment.run(context);
    throw std::logic_error("no experiment " + name);
  }

  static void expect_sound(const ExperimentResult& result) {
    EXPECT_TRUE(result.converged) << result.message;  // which names inverted elements too
    EXPECT_LT(result.numbers["gas_residual"].get<double>(), 1e-6);
    for (const Plot& plot : result.plots) EXPECT_NO_THROW(plot.validate()) << plot.name;
  }

  // A cell by its column's name.
  static double number(const ExperimentResult& result, const std::vector<TableCell>& row, const std::string& column) {
    for (std::size_t i = 0; i < row.size(); ++i)
      if (result.table.columns[i].name == column) return std::get<double>(row[i]);
    throw std::logic_error("no column " + column);
  }

  static ReferenceRow r4_row(double beta) {
    for (const ReferenceRow& row : read_reference("r4_chamber"))
      if (row.text("law") == "iso" && row.text("nu") == "0.4999" && std::abs(row.number("beta") - beta) < 1e-9)
        return row;
    throw std::logic_error("no such reference");
  }

  SceneFolder folder_;
};

// Against the reference itself, read here, and against the gas law from the table's own volumes.
TEST_F(ChamberExperiments, TheCuboidComesToTheReferencesVolumeAndPressure) {
  for (const double beta : {1.1, 0.975}) {
    SCOPED_TRACE(beta);
    const std::string value = std::to_string(beta);
    const ExperimentResult result = run(
        beta > 1.0 ? "5.3.1" : "5.3.2", "hollow_cuboid", "0.02", "0.012",
        "betas: [" + value + "]\npump: {mesh: coarse, beta: " + value + ", beta_per_step: 0.01, duration_s: 0.5}\n");
    expect_sound(result);
    ASSERT_EQ(result.table.rows.size(), 2u);
    const ReferenceRow reference = r4_row(beta);
    for (const auto& row : result.table.rows) {
      const double volume_m3 = 1e-6 * number(result, row, "volume [ml]"),
                   pressure_pa = number(result, row, "pressure [Pa]");
      EXPECT_NEAR(pressure_pa, 101000.0 * (beta * 2.36531e-5 / volume_m3 - 1.0), 1e-5 * 101000.0);
    }
    EXPECT_NEAR(1e-6 * number(result, result.table.rows[1], "volume [ml]") / reference.number("V_m3"), 1.0, 2e-3);
    EXPECT_NEAR(number(result, result.table.rows[1], "pressure [Pa]") / reference.number("P_gauge_Pa"), 1.0, 0.03);
    EXPECT_NEAR(result.numbers["worst_pressure_error"]["fine"].get<double>(),
                std::abs(number(result, result.table.rows[1], "pressure [Pa]") / reference.number("P_gauge_Pa") - 1.0),
                1e-9);
    EXPECT_LT(result.numbers["worst_pressure_error"]["fine"].get<double>(),
              result.numbers["worst_pressure_error"]["coarse"].get<double>());
  }
}

// By a hundredth a step and no faster, to the rest state of the same mesh, short of the volume that the source expects.
TEST_F(ChamberExperiments, TheCuboidIsPumpedStepByStepToItsRestState) {
  const ExperimentResult result =
      run("5.3.1", "hollow_cuboid", "0.02", "0.02",
          "betas: [1.1]\npump: {mesh: coarse, beta: 1.1, beta_per_step: 0.01, duration_s: 1}\n");
  expect_sound(result);
  const auto& pumped = result.numbers["pumped"];
  const std::vector<double> volumes_m3 = pumped["volumes_m3"];
  ASSERT_EQ(volumes_m3.size(), 61u);
  EXPECT_NEAR(volumes_m3[0], 2.36531e-5, 1e-10);
  for (std::size_t i = 1; i <= 10; ++i) {
    EXPECT_GT(volumes_m3[i], volumes_m3[i - 1]) << i;
    EXPECT_LT(volumes_m3[i], (1.0 + 0.01 * double(i)) * 2.36531e-5) << i;
  }
  EXPECT_NEAR(pumped["volume_m3"].get<double>(), result.numbers["volume_m3"]["coarse"].get<double>(), 1e-9);
  EXPECT_EQ(pumped["source_volume_m3"], 2.60184e-5);
  EXPECT_LT(pumped["volume_m3"].get<double>(), 2.57e-5);
}

TEST_F(ChamberExperiments, BubblefingerBendsAwayFromItsWedgesOnEveryMesh) {
  const ExperimentResult result =
      run("6.3.4", "bubblefinger", "0.014", "0.010",
          "set_up: {gravity_m_s2: [0, 0, 0], chambers: {main: {initial_pressure_pa: 1.0e5}}}\n"
          "betas: {coarse: [1, 1.75, 2.45, 2.57], fine: [1, 1.75, 2.45]}\n");
  expect_sound(result);
  EXPECT_LT(result.numbers["tip_difference"].get<double>(), 0.03);
  EXPECT_GT(result.numbers["tip_difference"].get<double>(), 1e-6);  // of two meshes
  EXPECT_GT(result.numbers["bends_down_m"]["coarse"].get<double>(), 0.02);
  EXPECT_GT(result.numbers["bends_down_m"]["fine"].get<double>(), 0.02);
  int shapes = 0;
  for (const Plot& plot : result.plots) {
    if (plot.name.find("shape") == std::string::npos) continue;
    ++shapes;
    for (const Series& series : plot.series) EXPECT_EQ(series.style, SeriesStyle::lines) << "edges, not squares";
  }
  EXPECT_EQ(shapes, 2);
  // Without gravity, and at a pressure that follows from 1e5 Pa.
  for (const auto& row : result.table.rows) {
    const double growth = number(result, row, "V / V0"), beta = number(result, row, "beta");
    EXPECT_NEAR(number(result, row, "pressure [Pa]"), 1.0e5 * (beta / growth - 1.0), 1.0);
    if (beta > 1.0) continue;
    EXPECT_NEAR(growth, 1.0, 1e-9);
  }
}

TEST_F(ChamberExperiments, BubblebotStretchesOnTheInflatedSideAndBendsAwayFromIt) {
  for (const std::string chamber : {"a", "c"}) {
    SCOPED_TRACE(chamber);
    const ExperimentResult result =
        run("6.3.5", "bubblebot", "0.03", "0.02",
            "chamber: " + chamber + "\nset_up: {chambers: {" + chamber + ": {flow_ml_s: 0}}}\nbetas: [1, 2.5, 5]\n" +
                "pump: {mesh: coarse, beta: 5, beta_per_step: 0.2, duration_s: 0.5}\n");
    expect_sound(result);
    EXPECT_LT(result.numbers["tip_difference"].get<double>(), 0.03);
    for (const std::string mesh : {"coarse", "fine"}) {
      EXPECT_GT(result.numbers["bends_away_m"][mesh].get<double>(), 0.01);
      EXPECT_GT(result.numbers["stretches_m"][mesh].get<double>(), 0.015);
      const auto& quality = result.numbers["quality"]["ours"][mesh];
      EXPECT_GT(quality["below_half_inflated"].get<int>(), quality["below_half"].get<int>());
      EXPECT_LT(quality["below_half_inflated"].get<int>(), quality["elements"].get<int>());
    }
    EXPECT_EQ(result.numbers["quality"]["source"]["fine"]["below_half"], 28865);
    // Full, and in time as at rest but for the swing.
    EXPECT_NEAR(result.numbers["pumped_growth"].get<double>(), number(result, result.table.rows[3], "V / V0"), 0.15);
  }
}

TEST_F(ChamberExperiments, RefuseSettingsThatMakeNoSense) {
  EXPECT_THROW(run("6.3.4", "bubblefinger", "0.03", "0.03", "betas: []\n"), std::exception);
  EXPECT_THROW(run("6.3.4", "bubblefinger", "0.03", "0.03", "betas: [1, 9]\n"), std::invalid_argument);
  EXPECT_THROW(run("6.3.5", "bubblebot", "0.03", "0.03", "chamber: a\nbetas: [1]\n"), std::invalid_argument);
  const std::string pump = "pump: {mesh: fine, beta: 5, beta_per_step: 0.2, duration_s: 0.5}\n";
  EXPECT_THROW(run("6.3.5", "bubblebot", "0.03", "0.03", "chamber: d\nbetas: [1]\n" + pump), std::invalid_argument);
  EXPECT_THROW(run("6.3.5", "bubblebot", "0.03", "0.03", "betas: {coarse: [1]}\n" + pump), SettingsError);
}

}  // namespace
}  // namespace soft_robot_lab
