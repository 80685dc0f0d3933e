// SPDX-License-Identifier: BSD-3-Clause
// What a run does and writes, on the bar with two cables. The order of commands matters, so each test loads its own
// scene.
#include "soft_robot_lab/robot/scene/run_scene.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "scene_files.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"

namespace soft_robot_lab {
namespace {

using Json = nlohmann::ordered_json;

struct Outcome {
  RunReport report;
  Json json;
  std::string summary;
};

Scene load(const SceneFolder& folder, const std::string& text) {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  return load_scene(folder.write("scene.yaml", "include: bar.yaml\n" + text), options);
}

Outcome run(const std::string& text, const RunProgress& progress = {}) {
  const SceneFolder folder;
  Scene scene = load(folder, text);
  Outcome outcome;
  outcome.report = run_scene(scene, progress);
  outcome.json = Json::parse(result_json(scene, outcome.report));
  outcome.summary = result_summary(scene, outcome.report);
  return outcome;
}

std::vector<std::string> keys(const Json& json) {
  std::vector<std::string> names;
  for (const auto& item : json.items()) names.push_back(item.key());
  return names;
}

using Names = std::vector<std::string>;

TEST(RunScene, WritesTheKeysOfAnEquilibrium) {
  const Outcome outcome = run("run: {mode: equilibrium, commands: [{time_s: 0, left: 0.95}]}\n");
  EXPECT_TRUE(outcome.report.solve.converged) << outcome.report.solve.message;
  EXPECT_EQ(keys(outcome.json), (Names{"markers", "cables", "chambers", "reaction", "reactions", "solver"}));
  EXPECT_EQ(keys(outcome.json["markers"]), (Names{"tip", "middle"}));
  EXPECT_EQ(keys(outcome.json["markers"]["tip"]), (Names{"position_m", "displacement_m"}));
  EXPECT_EQ(keys(outcome.json["cables"]), (Names{"left", "right"}));
  EXPECT_EQ(keys(outcome.json["cables"]["left"]),
            (Names{"length_m", "rest_length_m", "tension_n", "stretch_m", "slack_m", "pretension_n"}));
  EXPECT_TRUE(outcome.json["chambers"].is_object());
  EXPECT_EQ(keys(outcome.json["solver"]), (Names{"converged", "iterations", "residual", "steps", "wall_s", "nodes",
                                                 "elements", "inverted", "path", "warnings"}));
  EXPECT_EQ(outcome.json["solver"]["converged"], true);
  EXPECT_EQ(outcome.json["solver"]["inverted"], 0);
  EXPECT_EQ(outcome.json["solver"]["path"][0]["stage"], "newton");
  EXPECT_EQ(keys(outcome.json["reaction"]), (Names{"force_n", "moment_nm"}));
  EXPECT_LT(outcome.json["solver"]["residual"].get<double>(), 1e-6);
  EXPECT_NE(outcome.summary.find("marker tip at ["), std::string::npos);
  EXPECT_NE(outcome.summary.find("actuator left at command 0.95, tension "), std::string::npos);
}

TEST(RunScene, WritesWhatTouchesAndNothingElse) {
  const Outcome outcome =
      run("contact:\n"
          "  friction: [{between: [post, skin], coefficient: 0.3}]\n"
          "  obstacles:\n"
          "    - {name: post, cylinder: {start_m: [0.08, -0.025, -1], end_m: [0.08, -0.025, 1], radius_m: 0.01}}\n"
          "    - {name: wall, plane: {point_m: [0.2, 0, 0], normal: [-1, 0, 0]}}\n"
          "    - {name: lid, box: {size_m: [0.05, 0.02, 0.1], center_m: [0.05, 0.04, 0]}, friction: 0.1,\n"
          "       motion: [{time_s: 0}, {time_s: 1, translation_m: [0, 0.01, 0], rotation_rad: [0, 0.1, 0]}]}\n"
          "run: {mode: equilibrium}\n");
  ASSERT_TRUE(outcome.report.solve.converged) << outcome.report.solve.message;
  EXPECT_EQ(keys(outcome.json),
            (Names{"markers", "cables", "chambers", "reaction", "reactions", "contacts", "solver"}));
  ASSERT_EQ(outcome.json["contacts"].size(), 1u);
  const Json& post = outcome.json["contacts"][0];
  EXPECT_EQ(keys(post), (Names{"between", "force_n", "normal_force_n", "area_m2", "largest_penetration_m",
                               "sticking_area_m2", "slipping_area_m2"}));
  EXPECT_EQ(post["between"], Json({"skin", "post"}));
  EXPECT_GT(post["force_n"][1].get<double>(), 0.01);
  EXPECT_LT(post["largest_penetration_m"].get<double>(), 1e-5);
  EXPECT_NEAR(post["sticking_area_m2"].get<double>() + post["slipping_area_m2"].get<double>(),
              post["area_m2"].get<double>(), 1e-12);
  EXPECT_NE(outcome.summary.find("touches post with "), std::string::npos) << outcome.summary;
}

TEST(RunScene, SaysWhereFreeThingsAreAndWhatTheyTouch) {
  const Outcome outcome =
      run("gravity_m_s2: [0, 0, -9.81]\n"
          "contact:\n"
          "  obstacles:\n"
          "    - {name: floor, plane: {point_m: [0, 0, -0.1], normal: [0, 0, 1]}}\n"
          "    - {name: ball, sphere: {center_m: [0.3, 0, -0.09], radius_m: 0.01}, mass_kg: 0.01}\n"
          "    - {name: high, sphere: {center_m: [0.4, 0, 0.5], radius_m: 0.01}, mass_kg: 0.01}\n"
          "run: {mode: dynamic, duration_s: 0.1}\n");
  EXPECT_NE(outcome.summary.find("free ball at [300.000, 0.000, -90."), std::string::npos) << outcome.summary;
  EXPECT_NE(outcome.summary.find(" mm/s, touches floor\n"), std::string::npos) << outcome.summary;
  EXPECT_NE(outcome.summary.find("free high at [400.000, 0.000, 4"), std::string::npos) << outcome.summary;
  EXPECT_NE(outcome.summary.find(" mm/s, touches nothing\n"), std::string::npos) << outcome.summary;
}

// Its first half did not converge, and its second, which did, took the reason away.
TEST(RunScene, SaysWhyAHalvedStepDidNotConverge) {
  const SceneFolder folder;
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  Scene scene = load_scene(
      folder.write(
          "spin.yaml",
          "body:\n"
          "  solid: {box: {size_m: [0.02, 0.02, 0.06], center_m: [0, 0, 0.03]}}\n"
          "  element_size_m: 0.03\n"
          "  element: linear\n"
          "  material: {poissons_ratio: 0.3}\n"
          "  fixed: [{box: {min_m: [-9, -9, -9], max_m: [9, 9, 1.0e-6]}}]\n"
          "gravity_m_s2: [0, 0, -9.81]\n"
          "contact:\n"
          "  obstacles: [{name: a, box: {center_m: [0, 0, 0.0801], size_m: [0.02, 0.02, 0.02]}, mass_kg: 0.01,\n"
          "               angular_velocity_rad_s: [1.0e+4, 0, 0]}]\n"
          "solver: {max_iterations: 4}\n"
          "run: {mode: dynamic, duration_s: 0.05}\n"),
      options);
  const SolveReport report = run_scene(scene).solve;
  ASSERT_FALSE(report.converged);
  EXPECT_GT(report.message.size(), report.message.find(" s: ") + 4) << report.message;
}

TEST(RunScene, ABodyThatLiesOnTheFloorNeedNotBeHeld) {
  const SceneFolder folder;
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  Scene scene = load_scene(folder.write("block.yaml",
                                        "body: {solid: {box: {size_m: [0.04, 0.02, 0.04], center_m: [0, 0.012, 0]}},\n"
                                        "       element_size_m: 0.02}\n"
                                        "gravity_m_s2: [0, -9.81, 0]\n"
                                        "contact: {friction: 0.5, obstacles: [{name: floor,\n"
                                        "          plane: {point_m: [0, 0, 0], normal: [0, 1, 0]}}]}\n"
                                        "run: {mode: dynamic, duration_s: 0.3}\n"),
                           options);
  const RunReport report = run_scene(scene);
  EXPECT_TRUE(report.solve.converged) << report.solve.message;
  const double weight_n = 9.81 * scene.simulation->body().node_masses_kg().sum();
  EXPECT_NEAR(scene.simulation->contacts()[0].force_n.y(), weight_n, 1e-3 * weight_n);
}

TEST(RunScene, WritesWhereFreeObstaclesAre) {
  const Outcome outcome =
      run("contact:\n  friction: 0.5\n  obstacles:\n"
          "  - {name: ball, mass_kg: 0.1, velocity_m_s: [0, 1, 0], sphere: {center_m: [0, 1, 0], radius_m: 0.01}}\n"
          "  - {name: coin, mass_kg: 0.01, cylinder: {start_m: [1, 0, 0], end_m: [1, 0.002, 0], radius_m: 0.01}}\n"
          "  - {name: floor, plane: {point_m: [0, 0, -5], normal: [0, 0, 1]}}\n"
          "gravity_m_s2: [0, 0, 0]\nsolver: {time_step_s: 0.01}\n"
          "run: {mode: dynamic, duration_s: 0.1}\n");
  ASSERT_TRUE(outcome.report.solve.converged) << outcome.report.solve.message;
  EXPECT_EQ(keys(outcome.json["obstacles"]), (Names{"ball", "coin"}));
  EXPECT_EQ(keys(outcome.json["obstacles"]["ball"]),
            (Names{"center_m", "rotation_rad", "velocity_m_s", "angular_velocity_rad_s"}));
  EXPECT_NEAR(outcome.json["obstacles"]["ball"]["center_m"][1].get<double>(), 1.1, 1e-9);
  EXPECT_NEAR(outcome.json["obstacles"]["ball"]["velocity_m_s"][1].get<double>(), 1.0, 1e-9);
  const Json& path = outcome.json["trajectory"]["obstacles"]["ball"];
  ASSERT_EQ(path.size(), 11u);
  EXPECT_NEAR(path[5]["center_m"][1].get<double>(), 1.05, 1e-9);
}

TEST(RunScene, PullsTheCableItCommands) {
  const Outcome outcome = run("gravity_m_s2: [0, 0, 0]\nrun: {commands: [{left: 0.95, right: 1.2}]}\n");
  const Json& left = outcome.json["cables"]["left"];
  EXPECT_NEAR(left["rest_length_m"].get<double>(), 0.1, 1e-3);
  EXPECT_NEAR(left["length_m"].get<double>(), 0.95 * left["rest_length_m"].get<double>(), 1e-4);
  EXPECT_GT(left["tension_n"].get<double>(), 0.1);
  EXPECT_EQ(outcome.json["cables"]["right"]["tension_n"].get<double>(), 0.0);
  EXPECT_LT(outcome.json["markers"]["tip"]["displacement_m"][1].get<double>(), -0.005);  // towards the left cable
}

TEST(RunScene, SolvesEveryTimedCommandAndReportsTheLast) {
  const Outcome there = run("run: {commands: [{time_s: 0, left: 0.95}]}\n");
  const Outcome back = run("run: {commands: [{time_s: 0, right: 0.93}, {time_s: 1, right: 1, left: 0.95}]}\n");
  EXPECT_TRUE(back.report.solve.converged);
  EXPECT_GT(back.report.solve.iterations, there.report.solve.iterations);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(back.json["markers"]["tip"]["position_m"][axis].get<double>(),
                there.json["markers"]["tip"]["position_m"][axis].get<double>(), 1e-6);
  }
}

// They are what most of the counted cost is, at rest and in time.
TEST(RunScene, CountsFactorisations) {
  const Outcome rest = run("run: {mode: equilibrium, commands: [{time_s: 0, left: 0.95}]}\n");
  EXPECT_GT(rest.report.solve.factorisations, 0);
  EXPECT_LE(rest.report.solve.factorisations, rest.report.solve.iterations);
  const Outcome motion = run("run: {mode: dynamic, duration_s: 0.1, commands: [{time_s: 0, left: 0.95}]}\n");
  EXPECT_GT(motion.report.solve.factorisations, 0);
  EXPECT_LE(motion.report.solve.factorisations, motion.report.solve.iterations);
}

// Central differences over a command, against what the run reports.
// A bar of next to no stiffness falls through itself; each of its steps is solved.
TEST(RunScene, DoesNotConvergeToElementsThatAreInsideOut) {
  const Outcome outcome =
      run("body: {element: linear, element_size_m: 0.05, material: {youngs_modulus_pa: 1.0e-3, stiffness_ratio: 1, "
          "poissons_ratio: 0.3}}\n"
          "cables: []\nrun: {mode: dynamic, duration_s: 0.3}\n");
  EXPECT_GT(outcome.report.solve.inverted_elements, 0);
  EXPECT_FALSE(outcome.report.solve.converged);
  EXPECT_NE(outcome.report.solve.message.find("are inverted at the end"), std::string::npos);
}

TEST(RunScene, WritesTheSensitivityOfEveryMarkerOnRequest) {
  const auto tip = [](const Outcome& outcome, int axis) {
    return outcome.json["markers"]["tip"]["position_m"][axis].get<double>();
  };
  const std::string tight = "solver: {tolerance: 1.0e-9}\n";
  const Outcome at = run(tight + "run: {sensitivity: true, commands: [{left: 0.9, right: 1.2}]}\n");
  const Outcome less = run(tight + "run: {commands: [{left: 0.8995, right: 1.2}]}\n");
  const Outcome more = run(tight + "run: {commands: [{left: 0.9005, right: 1.2}]}\n");
  ASSERT_TRUE(at.json.contains("sensitivity"));
  EXPECT_FALSE(less.json.contains("sensitivity"));
  EXPECT_EQ(keys(at.json["sensitivity"]), (Names{"tip", "middle"}));
  EXPECT_EQ(keys(at.json["sensitivity"]["tip"]), (Names{"left", "right"}));
  for (int axis = 0; axis < 3; ++axis) {
    const double difference = (tip(more, axis) - tip(less, axis)) / 0.001;
    EXPECT_NEAR(at.json["sensitivity"]["tip"]["left"][axis].get<double>(), difference, 1e-4);
    EXPECT_EQ(at.json["sensitivity"]["tip"]["right"][axis].get<double>(), 0.0);  // slack
  }
}

TEST(RunScene, RecordsATrajectoryInTime) {
  const Outcome outcome =
      run("solver: {time_step_s: 0.01}\n"
          "run: {mode: dynamic, duration_s: 0.2, record_every_s: 0.05, commands: [{time_s: 0.1, left: 0.95}]}\n");
  EXPECT_TRUE(outcome.report.solve.converged) << outcome.report.solve.message;
  EXPECT_EQ(keys(outcome.json),
            (Names{"markers", "cables", "chambers", "reaction", "reactions", "energy", "solver", "trajectory"}));
  const Json& trajectory = outcome.json["trajectory"];
  EXPECT_EQ(keys(trajectory), (Names{"time_s", "markers"}));
  ASSERT_EQ(trajectory["time_s"].size(), 5u);
  for (size_t i = 0; i < 5; ++i) EXPECT_NEAR(trajectory["time_s"][i].get<double>(), 0.05 * i, 1e-9);
  const Json& tip = trajectory["markers"]["tip"];
  ASSERT_EQ(tip.size(), 5u);
  EXPECT_EQ(tip[0], Json::parse("[0.1, 0.0, 0.0]"));
  EXPECT_LT(tip[2][1].get<double>(), -0.005);  // falling
  EXPECT_EQ(tip[4], outcome.json["markers"]["tip"]["position_m"]);
  EXPECT_GT(outcome.json["cables"]["left"]["tension_n"].get<double>(), 0.0);
}

TEST(RunScene, RecordsEveryStepByDefault) {
  const Outcome outcome = run("solver: {time_step_s: 0.01}\nrun: {mode: dynamic, duration_s: 0.07}\n");
  EXPECT_EQ(outcome.json["trajectory"]["time_s"].size(), 8u);
  EXPECT_GE(outcome.report.solve.steps, 7);
}

TEST(RunScene, EndsWhereItIsAskedToAndKeepsWhatIsDone) {
  std::vector<double> done;
  const auto progress = [&](double fraction) {
    done.push_back(fraction);
    return done.size() < 3;
  };
  const Outcome outcome =
      run("solver: {time_step_s: 0.01}\nrun: {mode: dynamic, duration_s: 0.1, record_every_s: 0.05}\n", progress);
  ASSERT_EQ(done.size(), 3u);
  EXPECT_NEAR(done[2], 0.3, 1e-12);
  EXPECT_FALSE(outcome.report.solve.converged);
  EXPECT_EQ(outcome.report.solve.message, "ended after 0.03 of 0.1 s, as asked");
  ASSERT_EQ(outcome.json["trajectory"]["time_s"].size(), 2u);
  EXPECT_NEAR(outcome.json["trajectory"]["time_s"][1].get<double>(), 0.03, 1e-12);
}

TEST(RunScene, EndsWithinAStepThatIsInterrupted) {
  const SceneFolder folder;
  Scene scene = load(folder, "solver: {time_step_s: 0.01}\nrun: {mode: dynamic, duration_s: 0.1}\n");
  scene.simulation->set_interrupt([&] { return scene.simulation->state().time_s > 0.035; });
  const RunReport report = run_scene(scene);
  EXPECT_TRUE(report.solve.interrupted && !report.solve.converged);
  EXPECT_NE(report.solve.message.find(" of 0.1 s, as asked"), std::string::npos) << report.solve.message;
  const std::vector<double>& times_s = report.trajectory.time_s;
  ASSERT_GE(times_s.size(), 2u);
  EXPECT_LT(times_s.back(), 0.1);
  EXPECT_GT(times_s.back(), times_s[times_s.size() - 2]) << "no state is there twice";
}

TEST(RunScene, GivesCommandsNoSoonerThanTheirTime) {
  const std::string run_of = "solver: {time_step_s: 0.01}\nrun: {mode: dynamic, duration_s: 0.1, commands: ";
  const Outcome free = run(run_of + "[]}\n");
  const Outcome late = run(run_of + "[{time_s: 0.05, left: 0.9}]}\n");
  const Json& unpulled = free.json["trajectory"]["markers"]["tip"];
  const Json& pulled = late.json["trajectory"]["markers"]["tip"];
  for (size_t i = 0; i <= 5; ++i) EXPECT_EQ(unpulled[i], pulled[i]);
  EXPECT_NE(unpulled[7], pulled[7]);
}

TEST(RunScene, WritesTheFrequenciesOfTheRestShape) {
  const Outcome outcome = run("run: {mode: modal, modes: 3}\n");
  EXPECT_TRUE(outcome.report.solve.converged);
  EXPECT_EQ(keys(outcome.json), (Names{"markers", "cables", "chambers", "solver", "frequencies_hz"}));
  const std::vector<double> found_hz = outcome.json["frequencies_hz"];
  ASSERT_EQ(found_hz.size(), 3u);
  // Reference R6: 5.04 Hz; these elements are as large as the bar is thick.
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(found_hz[i], 5.04, 0.05 * 5.04);
  EXPECT_GT(found_hz[2], 15.0);
  EXPECT_GT(outcome.json["solver"]["iterations"].get<int>(), 1);
  EXPECT_NE(outcome.summary.find("mode 3 at "), std::string::npos);
}

TEST(RunScene, WarnsOfACommandThatTheDriveHasNotReached) {
  const Outcome outcome = run(
      "cables: [{name: left, points_m: [[0, -0.007, 0], [0.1, -0.007, 0]], via_points: given, pull_speed_m_s: 0.02}]\n"
      "run: {mode: dynamic, duration_s: 0.1, commands: [{left: 0.9}]}\n");
  const Json& warnings = outcome.json["solver"]["warnings"];
  ASSERT_EQ(warnings.size(), 1u) << warnings.dump(2);
  EXPECT_EQ(warnings[0]["kind"], "command_not_reached");
  EXPECT_EQ(warnings[0]["actuator"], "left");
  EXPECT_EQ(warnings[0]["commanded"].get<double>(), 0.9);
  EXPECT_NEAR(warnings[0]["reached"].get<double>(), 0.98, 1e-3);
  EXPECT_NEAR(warnings[0]["size"].get<double>(), 0.08, 1e-3);
  EXPECT_NE(warnings[0]["text"].get<std::string>().find("actuator left: commanded to 0.9"), std::string::npos);
  EXPECT_EQ(run("run: {commands: [{left: 0.95}]}\n").json["solver"]["warnings"], Json::array());
}

TEST(RunScene, IsTheSameEveryTime) {
  const std::string text = "run: {sensitivity: true, commands: [{left: 0.95}, {left: 0.9, right: 1.2}]}\n";
  Json once = run(text).json;
  Json again = run(text).json;
  once["solver"].erase("wall_s");
  again["solver"].erase("wall_s");
  EXPECT_EQ(once.dump(), again.dump());
}

}  // namespace
}  // namespace soft_robot_lab
