// SPDX-License-Identifier: BSD-3-Clause
// The chart of error against CPU time: its ladder, what it concludes from its runs, and the program at its quickest.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "study/charts/field_chart.h"
#include "study/charts/manufactured_problem.h"
#include "study/charts/node_costs.h"
#include "study/charts/speed_claims.h"
#include "study/charts/speed_ladder.h"
#include "study/charts/speed_measurement.h"
#include "study/charts/speed_runs_file.h"
#include "run_program.h"

namespace soft_robot_lab {
namespace {

using Json = nlohmann::ordered_json;

SpeedLadder package_ladder() {
  ExperimentContext context;
  context.config_folder = std::string(SOFT_ROBOT_LAB_SOURCE) + "/config";
  return read_speed_ladder(context);
}

SpeedRun settled(const std::string& nu, bool bullet, double size_m, double error, double cost) {
  SpeedRun run;
  run.problem = "cantilever";
  run.poissons_ratio = nu;
  run.rung = bullet ? "implicit" : "quadratic";
  run.mode = "settled";
  run.bullet = bullet;
  run.size_m = size_m;
  run.ended = true;
  run.error = error;
  run.cost = cost;
  return run;
}

TEST(SpeedLadder, KnowsTheTruthOfEveryProblem) {
  const SpeedLadder ladder = package_ladder();
  ASSERT_EQ(ladder.problems.size(), 3u);
  for (const SpeedProblem& problem : ladder.problems) {
    ASSERT_EQ(problem.references_m.size(), problem.poissons_ratios.size());
    // Silicone hardly changes its volume, so its displacement hardly changes with Poisson's ratio.
    for (const Eigen::Vector3d& reference_m : problem.references_m)
      EXPECT_LT((reference_m - problem.references_m[0]).norm(), 0.02 * reference_m.norm()) << problem.name;
    // Our own fine meshes, which say how the other points move, meet the independent reference where there is one.
    ASSERT_EQ(problem.curves_m.size(), problem.poissons_ratios.size());
    for (std::size_t i = 0; i < problem.curves_m.size(); ++i) {
      ASSERT_EQ(problem.curves_m[i].cols(), 10);
      EXPECT_LT((problem.curves_m[i].col(0) - problem.references_m[i]).norm(), 3e-3 * problem.references_m[i].norm())
          << problem.name << " at " << problem.poissons_ratios[i];
    }
  }
  EXPECT_NEAR(ladder.problems[0].references_m[0].y(), -0.01475422, 1e-12);
}

TEST(SpeedLadder, ChoosesProblemsByName) {
  const SpeedLadder ladder = package_ladder();
  EXPECT_EQ(choose_problems(ladder, {}, {}).problems.size(), 3u);
  EXPECT_EQ(choose_problems(ladder, {"cook"}, {}).problems.at(0).name, "cook");
  EXPECT_EQ(choose_problems(ladder, {}, {"0.4999"}).problems.size(), 1u) << "the cantilever alone is known there";
  EXPECT_THROW(choose_problems(ladder, {"cook"}, {"0.3"}), std::invalid_argument);
  try {
    choose_problems(ladder, {"beam"}, {});
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "unknown problem 'beam'; known: cantilever, cook, cable_bar");
  }
}

TEST(SpeedMeasurement, TheBestRunsAreThoseThatNoOtherBeatsInBoth) {
  SpeedRun failed = settled("0.45", true, 0.01, 0.001, 0.01);
  failed.ended = false;
  const std::vector<SpeedRun> best =
      best_of({settled("0.45", true, 0.01, 0.5, 1.0), settled("0.45", true, 0.01, 0.6, 2.0), failed,
               settled("0.45", true, 0.01, 0.1, 9.0), settled("0.45", true, 0.01, 0.9, 0.1)});
  ASSERT_EQ(best.size(), 3u);
  EXPECT_EQ(best[0].error, 0.9);
  EXPECT_EQ(best[1].error, 0.5);
  EXPECT_EQ(best[2].error, 0.1);
}

TEST(SpeedMeasurement, AChanceHitOfBulletDoesNotCount) {
  std::vector<SpeedRun> runs = {settled("0.45", false, 0.01, 0.5, 0.01), settled("0.45", true, 0.01, 0.1, 0.1),
                                settled("0.45", true, 0.01, 0.51, 1.0)};
  runs[0].rung = "linear, Newton";
  runs[0].curve = {0.0, 0.5};
  runs[1].curve = {0.0, 0.9};
  runs[2].curve = {0.01, 0.49};
  judge_equilibria(runs);
  EXPECT_FALSE(runs[1].own_equilibrium);
  EXPECT_TRUE(runs[2].own_equilibrium);
}

// A chance hit by one point does not make a curve exact.
TEST(SpeedMeasurement, CountsTheWholeCurve) {
  SpeedProblem problem = package_ladder().problems.at(0);
  const MeasuringTools tools{SOFT_ROBOT_LAB_MESHER, "", 1.0 / 60.0, 0.2, 1.0};
  const SpeedRung rung{"quadratic", Overrides().set({"body", "element"}, "quadratic"), false, false, true, true, {},
                       {5.0}};
  const double error = measure(problem, 0, rung, 5.0, false, tools).error;
  problem.curves_m[0].col(5) *= 4.0;
  EXPECT_GT(measure(problem, 0, rung, 5.0, false, tools).error, error + 0.1);
}

// With one pressure each, quadratic elements are of second order where the pressure matters, of third where it does
// not; linear ones are of second order, and lock.
TEST(Convergence, IsOfTheOrderThatElementsPromise) {
  const auto order = [](double poissons_ratio, bool quadratic, int level) {
    const ManufacturedRun coarse = solve_manufactured(poissons_ratio, quadratic, level),
                          fine = solve_manufactured(poissons_ratio, quadratic, level + 1);
    EXPECT_TRUE(coarse.converged && fine.converged);
    return std::log2(coarse.error / fine.error);
  };
  EXPECT_GT(order(0.3, true, 1), 2.3);
  EXPECT_GT(order(0.499, true, 1), 1.0);
  EXPECT_GT(order(0.3, false, 2), 1.2);
  EXPECT_LT(order(0.499, false, 2), 0.3) << "locks";
}

TEST(SpeedRuns, AreReadAsTheyWereWritten) {
  const SceneFolder folder;
  SpeedRun run = settled("0.45", true, 0.01, 0.5, 0.01);
  run.message = "why";
  run.curve = {1.0, 2.0};
  write_runs(folder.path("runs.json"), {run});
  const std::vector<SpeedRun> read = read_runs(folder.path("runs.json"));
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(read[0].rung, run.rung);
  EXPECT_EQ(read[0].message, "why");
  EXPECT_EQ(read[0].error, 0.5);
  EXPECT_EQ(read[0].curve, run.curve);
  EXPECT_TRUE(read[0].bullet);
  EXPECT_THROW(read_runs(folder.path("missing.json")), std::runtime_error);
}

TEST(SpeedClaims, CountARungByItsWorstPoissonsRatio) {
  SpeedLadder ladder = package_ladder();
  ladder.problems.resize(1);
  ladder.problems[0].poissons_ratios = {"0.45", "0.49"};
  const std::vector<SpeedRun> runs = {
      settled("0.45", false, 0.02, 0.004, 0.1), settled("0.49", false, 0.02, 0.02, 0.1),  // not within 1 % at 0.49
      settled("0.45", false, 0.01, 0.003, 0.3), settled("0.49", false, 0.01, 0.008, 0.4),
      settled("0.45", true, 0.01, 0.5, 5.0),    settled("0.49", true, 0.01, 0.001, 50.0)};
  const Json numbers = check_claims(ladder, runs).numbers["cantilever"];
  EXPECT_EQ(numbers["every_poissons_ratio_within_1_percent"]["cpu_s_per_simulated_s"], 0.4);
  EXPECT_TRUE(numbers["every_poissons_ratio_within_0.5_percent"].is_null());
  EXPECT_DOUBLE_EQ(numbers["0.45"]["bullet"][0]["times_faster"].get<double>(), 50.0);
  EXPECT_TRUE(numbers["0.49"]["bullet"][0]["times_faster"].is_null()) << "we have none as exact";
  EXPECT_DOUBLE_EQ(numbers["0.45"]["elsewhere"][0]["times_faster"].get<double>(), 0.4);
}

TEST(SpeedClaims, CountChanceHitsOfBulletApart) {
  SpeedLadder ladder = package_ladder();
  ladder.problems.resize(1);
  ladder.problems[0].poissons_ratios = {"0.45"};
  SpeedRun hit = settled("0.45", true, 0.01, 0.1, 0.2);
  hit.own_equilibrium = false;
  const std::vector<SpeedRun> runs = {settled("0.45", false, 0.02, 0.05, 0.1), hit,
                                      settled("0.45", true, 0.005, 0.4, 20.0)};
  const Json numbers = check_claims(ladder, runs).numbers["cantilever"]["0.45"];
  ASSERT_EQ(numbers["bullet"].size(), 1u);
  EXPECT_DOUBLE_EQ(numbers["bullet"][0]["times_faster"].get<double>(), 200.0);
  ASSERT_EQ(numbers["bullet_with_chance_hits"].size(), 1u);
  EXPECT_DOUBLE_EQ(numbers["bullet_with_chance_hits"][0]["times_faster"].get<double>(), 2.0);
}

TEST(SpeedClaims, CompareErrorsAloneWhereNoCostIsKnown) {
  SpeedLadder ladder = package_ladder();
  ladder.problems.resize(1);
  ladder.problems[0].poissons_ratios = {"0.499"};
  const Json numbers = check_claims(ladder, {settled("0.499", false, 0.02, 0.05, 0.1)}).numbers["cantilever"]["0.499"];
  ASSERT_EQ(numbers["elsewhere"].size(), 3u);
  EXPECT_TRUE(numbers["elsewhere"][0]["ours"].is_object());
  EXPECT_TRUE(numbers["elsewhere"][0]["times_faster"].is_null());
}

TEST(ChartSpeedAccuracy, DrawsItsQuickPart) {
  const SceneFolder folder;
  const std::string charts = folder.path("charts");
  const Outcome outcome = run_program(SOFT_ROBOT_LAB_CHART, folder, "--quick --output " + charts);
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  for (const std::string name :
       {"speed_accuracy_cantilever_0.45.svg", "speed_accuracy_cantilever_0.4999.png", "convergence_cantilever.csv",
        "convergence_time.svg", "equilibrium_cantilever_0.45.svg", "cost_of_nodes_motion.svg",
        "cost_of_nodes_equilibrium.svg", "release_time_step.svg", "speed_accuracy_motion.svg", "rollouts_per_core.svg",
        "against_the_field.svg", "report.html"})
    EXPECT_TRUE(std::filesystem::exists(charts + "/" + name)) << name;
  const Json result = Json::parse(std::ifstream(charts + "/speed_accuracy.json"));
  EXPECT_EQ(result["converged"], true) << result["message"];
  int bullet = 0;
  for (const Json& row : result["table"]) {
    const std::string method = row["method"];
    if (method.rfind("Bullet", 0) == 0) {
      ++bullet;
      continue;
    }
    if (method == "quadratic, Newton") {
      EXPECT_LT(row["error [%]"].get<double>(), row["elements"] < 20 ? 35.0 : 7.0) << row;
    }
    if (row["question"] == "equilibrium") {
      EXPECT_LE(row["iterations"].get<double>(), 6.0) << row;
    }
  }
  EXPECT_EQ(bullet > 0, std::filesystem::exists(SOFT_ROBOT_LAB_BULLET_PEER));
  for (const std::string nu : {"0.45", "0.4999"}) {
    for (const Json& point : result["cantilever"][nu]["elsewhere"])
      EXPECT_TRUE(point["ours"].is_object() || point["error_percent"] < 4.0) << point;
  }
  for (const Json& run : result["motion"]) {
    EXPECT_EQ(run["unsolved"], 0) << run;
    EXPECT_EQ(run.contains("training_cpu_s"), run.contains("modes")) << run;
    EXPECT_LT(run["rms_mm"].get<double>(), run.contains("modes") ? 20.0 : 2.0) << run;
  }
  int published = 0;
  for (const Json& point : result["field"]) published += point.contains("source") ? 1 : 0;
  EXPECT_EQ(published, static_cast<int>(package_ladder().published.size()));
  EXPECT_EQ(result["rollouts"].size(), 2u);
}

TEST(NodeCosts, ExponentsAreOfFineMeshesAlone) {
  std::vector<SpeedRun> runs;
  for (const int nodes : {100, 1000, 2000, 4000}) {
    runs.push_back(settled("0.499", false, 0.01, 0.0, nodes < 1000 ? 1.0 : 1e-6 * std::pow(nodes, 1.5)));
    runs.back().nodes = nodes;
  }
  EXPECT_NEAR(exponent(runs, 1000).value(), 1.5, 1e-12);
  EXPECT_FALSE(exponent(runs, 2000).has_value()) << "two meshes prove nothing";
}

TEST(FieldChart, TellsWhatRanHereFromWhatWasPublished) {
  SpeedRun early = settled("0.45", true, 0.02, 0.1, 0.01), bullet = settled("0.45", true, 0.02, 0.5, 2.0);
  early.own_equilibrium = false;
  bullet.nodes = 100;
  PublishedFigure rod{"rod", {}, 0.5, "1 s in 2 s", "a rod", "a paper"};
  const std::vector<FieldPoint> points = field_points({bullet, early}, "0.45", {}, {rod});
  ASSERT_EQ(points.size(), 2u) << "what stopped before its rest state is no answer";
  EXPECT_EQ(points[0].group, "Bullet, run here: cantilever");
  EXPECT_DOUBLE_EQ(points[0].times_real_time, 0.5);
  EXPECT_DOUBLE_EQ(points[0].unknowns.value(), 300.0);
  EXPECT_EQ(points[1].group, "published, not run here");
  EXPECT_EQ(points[1].error, "none stated");
  EXPECT_EQ(plot_field(points).series.size(), 1u) << "where unknowns are not stated there is no place in the picture";
}

TEST(ChartSpeedAccuracy, RefusesAPartItDoesNotKnow) {
  const SceneFolder folder;
  const Outcome outcome = run_program(SOFT_ROBOT_LAB_CHART, folder, "--part speed --output " + folder.path("charts"));
  EXPECT_EQ(outcome.exit_status, 2);
  EXPECT_NE(outcome.err.find("unknown part 'speed'; known: errors, convergence, nodes, motion, rollouts"),
            std::string::npos)
      << outcome.err;
}

TEST(ChartSpeedAccuracy, RefusesAProblemItDoesNotKnow) {
  const SceneFolder folder;
  const Outcome outcome = run_program(SOFT_ROBOT_LAB_CHART, folder, "--problem beam --output " + folder.path("charts"));
  EXPECT_EQ(outcome.exit_status, 2);
  EXPECT_NE(outcome.err.find("beam"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace soft_robot_lab
