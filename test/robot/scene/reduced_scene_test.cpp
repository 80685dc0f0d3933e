// SPDX-License-Identifier: BSD-3-Clause
// Scenes with solver.method reduced, on a coarse bar with one cable, which bends it to one side.
#include <algorithm>
#include <cmath>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "robot/scene/background_training.h"
#include "robot/scene/scene_motion.h"
#include "block_beside.h"
#include "cabled_bar.h"
#include "soft_robot_lab/robot/scene/run_scene.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

using Json = nlohmann::ordered_json;

struct Outcome {
  RunReport report;
  Json json;
};

const std::string kMotion =
    "run: {mode: dynamic, duration_s: 2, commands: [{time_s: 0, left: 0.93}, {time_s: 1, left: 0.96}]}\n";
const std::string kReduced = "method: reduced, tolerance_m: 2.0e-4, commands: {left: [0.9, 1]}";

class ReducedScene : public testing::Test {
 protected:
  static void SetUpTestSuite() { folder_ = new CabledBar; }
  static void TearDownTestSuite() { delete folder_; }

  static Scene load(const std::string& solver, const std::string& rest, ReducedUse use = ReducedUse::trained) {
    return folder_->load("solver: {time_step_s: 0.05, " + solver + "}\n" + rest, use);
  }

  static Outcome run(const std::string& solver, const std::string& rest) {
    Scene scene = load(solver, rest);
    Outcome outcome;
    outcome.report = run_scene(scene);
    outcome.json = Json::parse(result_json(scene, outcome.report));
    return outcome;
  }

  static std::string refusal(const std::string& solver, const std::string& rest, ReducedUse use = ReducedUse::trained) {
    try {
      load(solver, rest, use);
    } catch (const SettingsError& error) {
      return error.what();
    }
    return "";
  }

  static CabledBar* folder_;
};
CabledBar* ReducedScene::folder_ = nullptr;

double largest_distance_m(const Trajectory& a, const Trajectory& b) {
  double largest_m = 0.0;
  for (std::size_t i = 0; i < a.markers_m.size(); ++i)
    largest_m = std::max(largest_m, (a.markers_m[i] - b.markers_m[i]).colwise().norm().maxCoeff());
  return largest_m;
}

// By the full model, where the audit ends.
TEST_F(ReducedScene, HasNewtonsSensitivities) {
  const std::string rest = "run: {mode: equilibrium, sensitivity: true, commands: [{time_s: 0, left: 0.93}]}\n";
  const Outcome fast = run(kReduced, rest), full = run("method: newton", rest);
  ASSERT_TRUE(fast.report.solve.converged) << fast.report.solve.message;
  EXPECT_FALSE(fast.report.left_reduced);
  ASSERT_GT(full.report.sensitivity.norm(), 0.0);
  EXPECT_LT((fast.report.sensitivity - full.report.sensitivity).norm(), 1e-3 * full.report.sensitivity.norm());
}

TEST_F(ReducedScene, MovesAsNewtonWithinTheErrorThatItStates) {
  const Outcome fast = run(kReduced, kMotion), full = run("method: newton", kMotion);
  ASSERT_TRUE(fast.report.solve.converged) << fast.report.solve.message;
  ASSERT_EQ(fast.report.trajectory.markers_m.size(), full.report.trajectory.markers_m.size());
  const Json& reduced = fast.json["reduced"];
  const double stated_m = reduced["held_out"]["transient"]["max_m"].get<double>();
  EXPECT_LE(largest_distance_m(fast.report.trajectory, full.report.trajectory), 2.0 * stated_m);
  EXPECT_LT(full.report.trajectory.markers_m.back()(1, 0), -0.005);  // it did move
  EXPECT_LE(reduced["held_out"]["transient"]["rms_m"].get<double>(), 2.0e-4);
  EXPECT_LE(reduced["held_out"]["equilibria"]["rms_m"].get<double>(), 2.0e-4);
  EXPECT_EQ(reduced["commands"]["left"], (Json{0.9, 1.0}));
  EXPECT_EQ(reduced["left"], false);
  EXPECT_EQ(fast.report.solve.path[0].stage, SolveStage::reduced);
  EXPECT_TRUE(fast.json["solver"]["residual"].is_null());
  EXPECT_FALSE(fast.json.contains("reaction"));
  EXPECT_NEAR(fast.json["cables"]["left"]["tension_n"].get<double>(),
              full.json["cables"]["left"]["tension_n"].get<double>(), 0.05);
}

TEST_F(ReducedScene, IsTrainedOnceForAllRunsAndRepeatsItselfToTheLastBit) {
  const Outcome first = run(kReduced, kMotion), second = run(kReduced, kMotion);
  EXPECT_EQ(second.json["reduced"]["training"]["from_cache"], true);
  EXPECT_EQ(first.json["markers"], second.json["markers"]);
  EXPECT_EQ(first.json["reduced"]["held_out"], second.json["reduced"]["held_out"]);
  const Outcome heavier = run(kReduced, "body: {material: {density_kg_m3: 1200}}\n" + kMotion);
  EXPECT_EQ(heavier.json["reduced"]["training"]["from_cache"], false);
}

TEST_F(ReducedScene, TakesMoreModesForASmallerTolerance) {
  const auto modes = [](const std::string& tolerance) {
    return run("method: reduced, tolerance_m: " + tolerance + ", commands: {left: [0.9, 1]}", kMotion)
        .json["reduced"]["modes"]
        .get<int>();
  };
  EXPECT_LT(modes("2.0e-4"), modes("1.0e-5"));
}

TEST_F(ReducedScene, FindsTheEquilibriaOfNewton) {
  const std::string rest = "run: {mode: equilibrium, commands: [{time_s: 0, left: 0.92}]}\n";
  const Outcome fast = run(kReduced, rest), full = run("method: newton", rest);
  ASSERT_TRUE(fast.report.solve.converged);
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(fast.json["markers"]["tip"]["position_m"][axis].get<double>(),
                full.json["markers"]["tip"]["position_m"][axis].get<double>(),
                2.0 * fast.json["reduced"]["held_out"]["equilibria"]["max_m"].get<double>());
}

TEST_F(ReducedScene, GoesOnByNewtonFromACommandThatItWasNotTrainedFor) {
  const std::string rest =
      "run: {mode: dynamic, duration_s: 3, commands: [{time_s: 0, left: 0.95}, {time_s: 1, left: 0.85}]}\n";
  const Outcome fast = run(kReduced, rest), full = run("method: newton", rest);
  ASSERT_TRUE(fast.report.solve.converged) << fast.report.solve.message;
  EXPECT_EQ(fast.json["reduced"]["left"], true);
  ASSERT_EQ(fast.report.solve.warnings.size(), 1u);
  EXPECT_EQ(fast.report.solve.warnings[0].kind, "outside_training");
  EXPECT_NE(fast.report.solve.warnings[0].text.find("command 0.85 of left is outside [0.9, 1]"), std::string::npos);
  ASSERT_EQ(fast.report.solve.path.front().stage, SolveStage::reduced);
  for (std::size_t i = 1; i < fast.report.solve.path.size(); ++i)
    EXPECT_TRUE(may_follow(fast.report.solve.path[i - 1].stage, fast.report.solve.path[i].stage));
  const Eigen::Matrix3Xd apart = fast.report.trajectory.markers_m.back() - full.report.trajectory.markers_m.back();
  EXPECT_LT(apart.colwise().norm().maxCoeff(), 5e-5);  // newton has forgotten where it took over
  EXPECT_TRUE(fast.json["solver"]["residual"].is_number());
  EXPECT_TRUE(fast.json.contains("reaction"));
}

TEST_F(ReducedScene, IsAuditedOnItsWayAndAtItsEnd) {
  const Json reduced = run(kReduced + ", audit_every_s: 0.6", kMotion).json["reduced"];
  EXPECT_EQ(reduced["audits"]["states"], 4);  // at 0.6, 1.2, 1.8 and 2 s
  EXPECT_EQ(reduced["audits"]["failed"], false);
  EXPECT_GT(reduced["audits"]["largest_estimate_m"].get<double>(), 1e-7);
  EXPECT_LT(reduced["audits"]["largest_estimate_m"].get<double>(), reduced["audits"]["limit_m"].get<double>());
  EXPECT_EQ(reduced["training"]["from_cache"], true);  // of other scenes with the same model
}

TEST_F(ReducedScene, ShowsARestStateAsItsAuditCorrectsIt) {
  const std::string rest = "run: {mode: equilibrium, commands: [{time_s: 0, left: 0.92}]}\n";
  const Outcome fast = run(kReduced, rest), full = run("method: newton", rest);
  const auto distance_m = [&](const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) { return (a - b).norm(); };
  Scene scene = load(kReduced, rest);
  SceneMotion motion(scene);
  motion.set_command("left", 0.92);
  ASSERT_TRUE(motion.solve_equilibrium().converged);
  const Eigen::Matrix3Xd reduced_m = motion.markers_m();
  motion.show();
  const Eigen::Vector3d shown_m = scene.simulation->marker_position(0);
  Eigen::Vector3d newton_m;
  for (int axis = 0; axis < 3; ++axis) newton_m[axis] = full.json["markers"]["tip"]["position_m"][axis].get<double>();
  EXPECT_LT(distance_m(shown_m, newton_m), 0.1 * distance_m(reduced_m.col(0), newton_m));
}

// What the model was not trained for, whose commands say nothing of it.
TEST_F(ReducedScene, AuditsFindUntrainedGravityLoadsAndContactAndNewtonAnswers) {
  const std::string rest = "run: {mode: equilibrium, commands: [{time_s: 0, left: 0.92}]}\n";
  const Scene trained = load(kReduced, rest);
  for (const std::string& other :
       {std::string("gravity_m_s2: [0, -9.81, 2]\n"), std::string("gravity_m_s2: [0, 9.81, 0]\n"),
        std::string("loads: [{box: {min_m: [0.099, -1, -1], max_m: [1, 1, 1]}, force_n: [0, 0, 0.02]}]\n"),
        std::string("contact: {obstacles: [{name: floor, plane: {point_m: [0, -0.014, 0], normal: [0, 1, 0]}}]}\n")}) {
    SCOPED_TRACE(other);
    Scene scene = load("method: newton", other + rest), same = load("method: newton", other + rest);
    SceneMotion motion(*scene.simulation, trained.reduction);
    motion.set_command("left", 0.92);
    const SolveReport report = motion.solve_equilibrium();
    EXPECT_TRUE(report.converged);
    EXPECT_TRUE(motion.left());
    EXPECT_TRUE(motion.audits().failed);
    // Newton may warn beside it, as of unstable shapes on its way to the floor.
    const auto untrained = std::find_if(report.warnings.begin(), report.warnings.end(),
                                        [](const auto& warning) { return warning.kind == "outside_training"; });
    ASSERT_NE(untrained, report.warnings.end());
    EXPECT_NE(untrained->text.find("audit"), std::string::npos);
    ASSERT_TRUE(run_scene(same).solve.converged);
    EXPECT_LT((scene.simulation->marker_position(0) - same.simulation->marker_position(0)).norm(), 1e-5);
  }
}

TEST_F(ReducedScene, AFailedAuditInMotionLeavesItToNewton) {
  const Scene trained = load(kReduced + ", audit_every_s: 0.5", kMotion);
  Scene scene = load("method: newton", "gravity_m_s2: [0, -9.81, 5]\n" + kMotion);
  SceneMotion motion(*scene.simulation, trained.reduction);
  motion.set_command("left", 0.93);
  for (int i = 0; i < 9; ++i) EXPECT_TRUE(motion.step().warnings.empty());
  EXPECT_FALSE(motion.left());
  const SolveReport audited = motion.step();
  EXPECT_TRUE(motion.left());
  ASSERT_EQ(audited.warnings.size(), 1u);
  EXPECT_NE(audited.warnings[0].text.find("from 0.5"), std::string::npos) << audited.warnings[0].text;
  EXPECT_EQ(motion.step().path.front().stage, SolveStage::newton);
}

// Over to newton and back, on the way from one command to another.
TEST_F(ReducedScene, HandsARobotThatMovesOverAndBackWithoutAJump) {
  Scene scene = load(kReduced, kMotion), whole = load("method: newton", kMotion);
  SceneMotion motion(scene), newton(whole);
  double apart_m = 0.0;
  for (int i = 0; i < 60; ++i) {
    for (SceneMotion* one : {&motion, &newton}) one->set_command("left", i < 30 ? 0.93 : 0.97);
    if (i == 10 || i == 32) {
      const Eigen::Matrix3Xd before_m = motion.markers_m();
      motion.to_newton("tried");
      EXPECT_FALSE(motion.reduced());
      EXPECT_LT((motion.markers_m() - before_m).norm(), 1e-12);
    }
    if (i == 20 || i == 40) {
      const Eigen::Matrix3Xd before_m = motion.markers_m();
      ASSERT_TRUE(motion.to_reduced());
      EXPECT_TRUE(motion.reduced());
      EXPECT_LT((motion.markers_m() - before_m).norm(), motion.audits().limit_m);
    }
    ASSERT_TRUE(motion.step().converged);
    ASSERT_TRUE(newton.step().converged);
    apart_m = std::max(apart_m, (motion.markers_m() - newton.markers_m()).norm());
  }
  EXPECT_LT(apart_m, 2.0 * motion.audits().limit_m);
  EXPECT_NEAR(motion.time_s(), newton.time_s(), 1e-9);
}

// Each solver goes on where another one is, on the way from one command to another.
TEST_F(ReducedScene, GoesOnWhereAnotherSolverIs) {
  Scene from = load("method: newton", kMotion);
  SceneMotion newton(from);
  newton.set_command("left", 0.94);
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(newton.step().converged);
  const SimulationState there = newton.place().full;
  const Eigen::Matrix3Xd there_m = newton.markers_m();
  ASSERT_GT(there.velocities_m_s.colwise().norm().maxCoeff(), 1e-3);
  ASSERT_TRUE(newton.step().converged);
  const Eigen::Matrix3Xd step_m = newton.markers_m() - there_m;
  for (const std::string& method : {std::string("method: newton"), std::string("method: xpbd"), kReduced}) {
    SCOPED_TRACE(method);
    Scene scene = load(method, kMotion);
    SceneMotion motion(scene);
    motion.go_on_from(there);
    EXPECT_EQ(motion.time_s(), there.time_s);
    EXPECT_EQ(motion.drives()[0].command, 0.94);
    EXPECT_EQ(motion.reduced(), method == kReduced);
    const double allowed_m = motion.reduced() ? motion.audits().limit_m : 1e-12;
    EXPECT_LE((motion.markers_m() - there_m).norm(), allowed_m);
    const Eigen::Matrix3Xd begun_m = motion.markers_m(), velocities_m_s = motion.place().full.velocities_m_s;
    EXPECT_LE((velocities_m_s - there.velocities_m_s).norm(), (motion.reduced() ? 0.1 : 0.0) * velocities_m_s.norm());
    ASSERT_TRUE(motion.step().converged);
    if (method != "method: xpbd") {  // which damps less than a long step of newton
      EXPECT_LT((motion.markers_m() - begun_m - step_m).norm(), 0.2 * step_m.norm());
    }
    SimulationState other = there;
    other.positions_m.conservativeResize(3, 7);
    EXPECT_THROW(motion.go_on_from(other), std::invalid_argument);
  }
}

TEST_F(ReducedScene, TakesNoStateThatItWasNotTrainedFor) {
  Scene scene = load(kReduced, kMotion);
  SceneMotion motion(scene);
  motion.set_command("left", 0.85);
  for (int i = 0; i < 20; ++i) motion.step();
  EXPECT_FALSE(motion.to_reduced());
  motion.set_command("left", 0.95);
  for (int i = 0; i < 40; ++i) motion.step();
  EXPECT_TRUE(motion.to_reduced());
}

TEST_F(ReducedScene, ComesBackToAPlaceToTheLastBit) {
  Scene scene = load(kReduced, kMotion);
  SceneMotion motion(scene);
  motion.set_command("left", 0.95);
  ASSERT_TRUE(motion.solve_equilibrium().converged);
  const SceneMotion::Place start = motion.place();
  const auto ends_m = [&] {
    motion.set_command("left", 0.92);
    for (int i = 0; i < 10; ++i) motion.step();
    return motion.markers_m();
  };
  const Eigen::Matrix3Xd first_m = ends_m();
  motion.to_newton("tried");
  motion.go_to(start);
  EXPECT_TRUE(motion.reduced());
  EXPECT_EQ(ends_m(), first_m);
}

TEST_F(ReducedScene, IsTrainedBesideWhatRuns) {
  const std::string other = "method: reduced, tolerance_m: 2.1e-4, commands: {left: [0.9, 1]}";
  const Scene scene = load(other, kMotion, ReducedUse::if_kept);
  EXPECT_TRUE(scene.untrained);
  EXPECT_FALSE(scene.reduction);
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.cache_folder = folder_->path("cache");
  options.actuator_factory = make_actuator;
  BackgroundTraining training;
  training.start(scene.file, options);
  EXPECT_NE(training.status().find("training"), std::string::npos) << training.status();
  std::shared_ptr<const SceneReduction> trained;
  while (!(trained = training.take()) && !training.failed()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  ASSERT_TRUE(trained) << training.status();
  EXPECT_EQ(training.status(), "");
  SceneMotion motion(*scene.simulation, nullptr);
  EXPECT_FALSE(motion.to_reduced());
  EXPECT_TRUE(motion.to_reduced(trained));
  EXPECT_TRUE(load(other, kMotion, ReducedUse::if_kept).reduction);
}

TEST_F(ReducedScene, TrainingThatFailsSaysWhyAndTrainingThatIsStoppedEnds) {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.cache_folder = folder_->path("cache");
  options.actuator_factory = make_actuator;
  options.method = "reduced";
  const std::string scene = folder_->write("creeps.yaml",
                                           "include: coarse.yaml\nbody: {hysteresis: {stiffness_ratio: 0.1, "
                                           "relaxation_time_s: 1}}\nsolver: {substeps: 3}\n");
  BackgroundTraining training;
  training.start(scene, options);
  while (!training.failed() && !training.take()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_NE(training.status().find("not trained: "), std::string::npos) << training.status();
  EXPECT_NE(training.status().find("hysteresis"), std::string::npos) << training.status();
  EXPECT_FALSE(training.take());
  options.overrides.set({"cables", "left", "compliance_m_n"}, 1e-4);
  training.start(scene, options);
  training.stop();
  EXPECT_EQ(training.status(), "");
  EXPECT_FALSE(training.take());
}

// A session's method in place of the file's, with what stands there for another one.
TEST_F(ReducedScene, AnotherMethodThanTheFilesLeavesItsKeysAlone) {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.cache_folder = folder_->path("cache");
  options.actuator_factory = make_actuator;
  const std::string scene = folder_->write(
      "methods.yaml",
      "include: coarse.yaml\nsolver: {method: reduced, tolerance_m: 2.0e-4, commands: {left: [0.9, 1]}}\n");
  options.method = "xpbd";
  EXPECT_EQ(load_scene(scene, options).simulation->options().method, SolverOptions::Method::xpbd);
  options.method = "newton";
  EXPECT_EQ(load_scene(scene, options).simulation->options().method, SolverOptions::Method::newton);
  options.method.clear();
  options.reduced = ReducedUse::by_newton;
  EXPECT_EQ(load_scene(scene, options).simulation->options().method, SolverOptions::Method::newton);
  options.method = "reduced";
  options.reduced = ReducedUse::trained;
  const std::string damped = folder_->write("second_order.yaml",
                                            "include: coarse.yaml\nsolver: {integrator: bdf2, substeps: 7, "
                                            "commands: {left: [0.9, 1]}}\n");
  EXPECT_TRUE(load_scene(damped, options).reduction);
}

TEST_F(ReducedScene, WithoutRangesOfCommandsTrainsForAsMuchAsMeetsTheTolerance) {
  const auto box_of = [](const std::string& tolerance_m) {
    return load("method: reduced, tolerance_m: " + tolerance_m, kMotion).reduction->choice.model->box;
  };
  const CommandBox wide = box_of("0.02"), narrow = box_of("2.0e-5");
  EXPECT_EQ(wide.min[0], 0.5);
  EXPECT_EQ(wide.max[0], 1.5);
  EXPECT_GT(narrow.min[0], 0.5);
  EXPECT_LT(narrow.min[0], 0.9);
  EXPECT_EQ(load("method: reduced, tolerance_m: 2.0e-5", kMotion).reduction->choice.model->box.min, narrow.min);
}

TEST_F(ReducedScene, RefusesWhatItDoesNotKnow) {
  const struct {
    std::string solver, rest, words;
  } cases[] = {
      {"method: reduced, commands: {right: [0.9, 1]}", kMotion, "left"},
      {"method: reduced, commands: {left: [0.9]}", kMotion, "two numbers"},
      {"method: reduced, commands: {left: [0.9, 0.95]}", kMotion, "rest command 1"},
      {"method: reduced, commands: {left: [0.9, 1], third: [0.9, 1]}", kMotion, "third"},
      {kReduced + ", modes: 41", kMotion, "modes"},
      {kReduced + ", audit_every_s: 0", kMotion, "audit_every_s"},
      {kReduced + ", integrator: bdf2", kMotion, "integrator other than implicit_euler"},
      {kReduced, "body: {hysteresis: {stiffness_ratio: 0.1, relaxation_time_s: 1}}\n" + kMotion, "viscosity"},
      {kReduced, "contact: {obstacles: [{name: floor, plane: {point_m: [0, -1, 0], normal: [0, 1, 0]}}]}\n" + kMotion,
       "contact"},
      {kReduced, "run: {mode: modal}\n", "mode modal"},
      {kReduced, "fidelity: {tolerance_m: 0.001}\n" + kMotion, "fidelity"},
      {"method: newton, tolerance_m: 1.0e-4", kMotion, "tolerance_m"},
  };
  for (const auto& one : cases) {
    const std::string words = refusal(one.solver, one.rest);
    EXPECT_NE(words.find(one.words), std::string::npos) << one.solver << one.rest << words;
  }
  EXPECT_NE(refusal(kReduced, kMotion, ReducedUse::refused).find("sessions and the programs simulate"),
            std::string::npos);
}

// A hollow cuboid whose pressure stays as it is over a step.
TEST_F(ReducedScene, RefusesAnExplicitChamberByItsName) {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  options.reduced = ReducedUse::trained;
  const std::string scene = "include: " SOFT_ROBOT_LAB_SOURCE
                            "/config/robots/hollow_cuboid/robot.yaml\nbody: {element_size_m: 0.02}\n"
                            "chambers: {main: {model: explicit}}\n"
                            "solver: {method: reduced, commands: {main: [1, 1.2]}}\n";
  try {
    load_scene(folder_->write("air.yaml", scene), options);
    ADD_FAILURE() << "not refused";
  } catch (const SettingsError& error) {
    EXPECT_NE(std::string(error.what()).find("actuator 'main': a reduced model knows no chamber of model explicit"),
              std::string::npos)
        << error.what();
  }
}

TEST_F(ReducedScene, RefusesAToleranceThatItDoesNotMeetAndSaysHowFarItIs) {
  const std::string words =
      refusal("method: reduced, modes: 3, tolerance_m: 1.0e-7, commands: {left: [0.9, 1]}", kMotion);
  EXPECT_NE(words.find("3 modes or fewer meets tolerance_m 1e-07: rms "), std::string::npos) << words;
}

}  // namespace
}  // namespace soft_robot_lab
