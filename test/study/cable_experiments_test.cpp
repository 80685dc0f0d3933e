// SPDX-License-Identifier: BSD-3-Clause
// The experiments with cables, on a small bar and with shorter lists than config/experiments has them.
#include <cmath>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "control/configuration_table.h"
#include "robot/scene/scene_files.h"
#include "study/experiment.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

const std::string kRobots = SOFT_ROBOT_LAB_SOURCE "/config/robots/";

class CableExperiments : public testing::Test {
 protected:
  ExperimentResult run(const std::string& name, const std::string& settings) {
    folder_.write("experiments/" + name + ".yaml", settings);
    ExperimentContext context;
    context.config_folder = folder_.path("");
    context.mesher = SOFT_ROBOT_LAB_MESHER;
    for (const Experiment& experiment : simulation_experiments()) {
      if (experiment.name != name) continue;
      const ExperimentResult result = experiment.run(context);
      for (const Plot& plot : result.plots) EXPECT_NO_THROW(plot.validate()) << plot.name;
      return result;
    }
    throw std::logic_error("no experiment " + name);
  }

  SceneFolder folder_;
};

std::string table(const std::string& gravity, const std::string& configurations) {
  return "robot: bar.yaml\ngravity_m_s2: " + gravity +
         "\nstep_m: 6.25e-5\nspring_stiffness_n_m: 2000\nspring_damping_n_s_m: 0.001\nshape: [middle, tip]\n" +
         configurations;
}

double tip_m(const ExperimentResult& result, std::size_t configuration, int axis) {
  return result.numbers["configurations"][configuration]["tip_m"][static_cast<std::size_t>(axis)];
}

TEST_F(CableExperiments, TakeConfigurationsOneAfterTheOther) {
  const ExperimentResult result =
      run("6.3.1", table("[0, 0, 0]",
                         "configurations: [{name: a, contractions: [1, 1]}, {name: b, contractions: [1.2, 0.9]},\n"
                         "  {name: c, contractions: [1, 1]}, {name: d, contractions: [0.9, 1]},\n"
                         "  {name: e, contractions: [0.9, 1]}]\nmoving: [e]\nreturns: [a, c]\n"));
  EXPECT_TRUE(result.converged) << result.message;
  const auto& all = result.numbers["configurations"];
  ASSERT_EQ(all.size(), 10u);  // with sliding cables, then with springs
  EXPECT_EQ(all[1]["steps"], (std::vector<double>{-320, 160}));
  EXPECT_EQ(all[6]["name"], "b");
  EXPECT_NEAR(tip_m(result, 0, 0), 0.1, 1e-9);  // nothing pulls, not even gravity
  EXPECT_GT(std::abs(tip_m(result, 1, 1)), 0.005);
  EXPECT_NEAR(tip_m(result, 3, 1), -tip_m(result, 1, 1), 0.1 * std::abs(tip_m(result, 1, 1)));
  EXPECT_LT(std::abs(tip_m(result, 6, 1)), 0.95 * std::abs(tip_m(result, 1, 1)));  // springs give way
  EXPECT_LT(result.numbers["left_behind_m"]["sliding"].get<double>(), 1e-6);
  EXPECT_LT(result.numbers["from_first_m"]["springs"].get<double>(), 1e-6);
  // At rest, and the same on the way there.
  EXPECT_EQ(all[3]["speed_m_s"], 0.0);
  EXPECT_GT(all[4]["speed_m_s"].get<double>(), 0.001);
  EXPECT_GT(std::abs(tip_m(result, 4, 1) - tip_m(result, 3, 1)), 1e-5);
}

// The source's motor positions, tables 6.4 and 6.5, follow from the contractions and the cables' length.
TEST_F(CableExperiments, HaveTheSourcesTables) {
  const std::vector<std::vector<int>> hammerbot = {{0, 0},     {-320, 288}, {-320, 480}, {144, -16},
                                                   {448, -16}, {-16, -16},  {336, 304},  {336, 304}},
                                      spinebot = {{0, 0},      {0, 258}, {0, 0},     {129, 0},
                                                  {258, -129}, {0, 0},   {129, 129}, {258, 258}};
  for (const auto& [name, length_m, motors] :
       {std::tuple("6.3.1", 0.1, hammerbot), std::tuple("6.3.2", 0.0805, spinebot)}) {
    SCOPED_TRACE(name);
    const YamlNode file =
        YamlNode::load_file(std::string(SOFT_ROBOT_LAB_SOURCE "/config/experiments/") + name + ".yaml");
    const std::vector<Configuration> all = read_configurations(file);
    ASSERT_EQ(all.size(), motors.size());
    for (std::size_t i = 0; i < all.size(); ++i)
      for (const std::size_t cable : {0u, 1u})
        EXPECT_EQ(std::lround((1.0 - all[i].commands[cable]) * length_m / file.number("step_m")), motors[i][cable])
            << all[i].name;
  }
}

TEST_F(CableExperiments, RefuseConfigurationsThatAreNotThere) {
  const std::string two = "configurations: [{name: a, contractions: [1, 1]}, {name: b, contractions: [1, 0.9]}]\n";
  EXPECT_THROW(run("6.3.2", table("[0, 0, 0]", two + "moving: [c]\nreturns: [a, b]\n")), SettingsError);
  EXPECT_THROW(run("6.3.2", table("[0, 0, 0]", two + "moving: [a]\nreturns: [a, b]\n")), SettingsError);
  EXPECT_THROW(run("6.3.2", table("[0, 0, 0]", two + "moving: []\nreturns: [a]\n")), SettingsError);
}

TEST_F(CableExperiments, PutTheSourcesStiffnessesBesideWhatItFound) {
  const ExperimentResult result = run(
      "4.3.2",
      "robot: bar.yaml\ngravity_m_s2: [0, -9.8, 0]\noverrides: {sheath_radius_m: 0.001, pull_speed_m_s: 0.1}\n"
      "contraction: 0.95\nsource: [{stiffness_n_m: 20, found: settles}, {stiffness_n_m: 25000, found: oscillates}]\n"
      "damping_n_s_m: 0.001\nsliding_stiffnesses_n_m: []\ntime_step_s: 0.0166667\nshort_step_s: 0.008\n"
      "duration_s: 1\nlast_s: 0.2\nsettled_swing_m: 0.0001\nlargest_error_m: 0.02\nlargest_iterations_a_step: 6\n");
  EXPECT_TRUE(result.converged) << result.message;
  const auto& all = result.numbers["stiffnesses"];
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[1]["stiffness_n_m"], 25000.0);
  EXPECT_EQ(all[1]["source_found"], "oscillates");
  for (const std::string model : {"sliding", "implicit_springs"}) {
    EXPECT_EQ(all[1][model]["settles"], true) << model;
    EXPECT_NEAR(all[1][model]["final_length_m"].get<double>(), 0.095, 5e-4) << model;
  }
  EXPECT_EQ(all[0]["explicit_springs"]["settles"], true);
  EXPECT_EQ(all[1]["explicit_springs"]["settles"], false);
  // A cable of two points is one spring, and as long as a sliding one of that stiffness.
  EXPECT_NEAR(all[0]["implicit_springs"]["final_length_m"].get<double>(),
              all[0]["sliding"]["final_length_m"].get<double>(), 1e-5);
}

TEST_F(CableExperiments, PullInBothOrders) {
  const ExperimentResult result = run(
      "6.3.3",
      "robots: [{name: Bar, scene: bar.yaml, contraction: 0.97, shape: [middle, tip]}]\ngravity_m_s2: 0.1\nstages: 2\n"
      "settle_s: 0.3\ntilt: 0.01\n");
  EXPECT_TRUE(result.converged) << result.message;
  // Too little to buckle: by whatever order, both cables lead to one place.
  EXPECT_EQ(result.table.rows.size(), 8u);
  EXPECT_LT(result.numbers["Bar"]["apart_m"]["equilibria"].get<double>(), 1e-5);
  const auto tip = result.numbers["Bar"]["tip_m"]["equilibria"]["left first"];
  EXPECT_NEAR(tip[0].get<double>(), 0.097, 0.001);
}

// The pseudo-inverse multiplies by one over the sum of the squared shape functions.
TEST_F(CableExperiments, FindWhatThePseudoInverseMultipliesBy) {
  folder_.write("bar_robot.yaml", "include: " + kRobots + "hanging_bar/robot.yaml\nbody: {element_size_m: 0.02}\n");
  const ExperimentResult result =
      run("pseudo_inverse",
          "robot: bar_robot.yaml\nstart_m: [0, 0, 0]\nend_near_m: [0, -0.1, 0]\nstiffness_n_m: 20\ncontraction: 0.9\n"
          "plug_radius_m: 0.003\nduration_s: 0.1\n");
  EXPECT_TRUE(result.converged) << result.message;
  const auto& ratio = result.numbers["force_ratio"];
  const std::pair<const char*, std::pair<double, double>> expected[] = {
      {"corner", {1.0, 1.0}}, {"edge", {2.0, 1.0}}, {"face", {3.0, 27.0 / 17.0}}, {"inside", {4.0, 16.0 / 7.0}}};
  for (const auto& [place, ratios] : expected) {
    EXPECT_NEAR(ratio["linear"][place].get<double>(), ratios.first, 1e-6) << place;
    EXPECT_NEAR(ratio["quadratic"][place].get<double>(), ratios.second, 1e-6) << place;
  }
}

TEST_F(CableExperiments, FindHowManyViaPointsAreEnough) {
  folder_.write("held.yaml",
                "include: " SOFT_ROBOT_LAB_SOURCE "/config/scenes/held_bar.yaml\nbody: {element_size_m: 0.02}\n");
  const ExperimentResult result =
      run("via_points", "scene: held.yaml\ncontractions: [1]\ncounts: [0, 3]\nreference_count: 24\n");
  EXPECT_TRUE(result.converged) << result.message;
  const auto& runs = result.numbers["runs"];
  ASSERT_EQ(runs.size(), 4u);  // the last with points of its own
  const auto off_m = [&](std::size_t i) {
    return std::abs(runs[i]["length_m"].get<double>() - runs[i]["true_length_m"].get<double>());
  };
  EXPECT_NEAR(runs[0]["length_m"].get<double>(), 0.13, 1e-9);
  EXPECT_NEAR(runs[0]["tension_n"].get<double>(), 0.0, 1e-9);
  EXPECT_GT(off_m(0), 3e-4);
  EXPECT_LT(off_m(1), 0.3 * off_m(0));
  EXPECT_LT(off_m(2), 0.1 * off_m(1));
  EXPECT_EQ(runs[3]["per_element"], true);
  EXPECT_NEAR(runs[3]["tension_n"].get<double>(), runs[2]["tension_n"].get<double>(),
              0.03 * runs[2]["tension_n"].get<double>());
}

}  // namespace
}  // namespace soft_robot_lab
