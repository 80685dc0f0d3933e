// SPDX-License-Identifier: BSD-3-Clause
// The way that a solve reports.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "test_bar.h"

namespace soft_robot_lab {
namespace {

std::string text_of(const std::vector<SolvePathStage>& path) {
  std::string text;
  for (const SolvePathStage& stage : path)
    text += (text.empty() ? "" : ", ") + std::string(name_of(stage.stage)) + " " + std::to_string(stage.count);
  return text;
}

bool has(const std::vector<SolvePathStage>& path, SolveStage stage) {
  return std::any_of(path.begin(), path.end(), [&](const SolvePathStage& at) { return at.stage == stage; });
}

void expect_allowed(const std::vector<SolvePathStage>& path) {
  ASSERT_FALSE(path.empty());
  for (std::size_t i = 1; i < path.size(); ++i)
    EXPECT_TRUE(may_follow(path[i - 1].stage, path[i].stage)) << i << " of " << text_of(path);
}

TEST(SolvePath, OfAnEasyStepIsNewtonAlone) {
  Simulation simulation = hanging_bar("model: sliding");
  const SolveReport report = simulation.step();
  ASSERT_TRUE(report.converged);
  ASSERT_EQ(report.path.size(), 1u) << text_of(report.path);
  EXPECT_EQ(report.path[0].stage, SolveStage::newton);
  EXPECT_EQ(report.path[0].count, report.iterations);
}

TEST(SolvePath, OfXpbdIsItsSweeps) {
  SolverOptions options;
  options.method = SolverOptions::Method::xpbd;
  Simulation simulation = hanging_bar("model: sliding", options);
  const SolveReport report = simulation.step();
  ASSERT_EQ(report.path.size(), 1u);
  EXPECT_EQ(report.path[0].stage, SolveStage::xpbd);
  EXPECT_EQ(report.path[0].count, report.iterations);
}

TEST(SolvePath, NamesTheRescuesOfAHardPull) {
  Simulation simulation = hanging_bar("compliance_m_n: 0");
  simulation.set_command("cable", 0.5);  // at once
  for (int step = 0; step < 3; ++step) {
    const SolveReport report = simulation.step();
    expect_allowed(report.path);
    if (step == 0) {
      EXPECT_GT(report.path.size(), 1u) << text_of(report.path);
      EXPECT_EQ(report.path.front().stage, SolveStage::newton);
    }
  }
}

TEST(SolvePath, ShowsWhereInvertedElementsAreLaidOutAnew) {
  Simulation simulation = hanging_bar("compliance_m_n: 0");
  SimulationState state = simulation.state();
  const auto& fixed = simulation.body().fixed();
  for (Eigen::Index node = 0; node < fixed.cols(); ++node)
    if (!fixed.col(node).any()) state.positions_m(1, node) *= -0.5;  // into the clamp
  simulation.set_state(state);
  bool untangled = false;
  for (int step = 0; step < 4; ++step) {
    const SolveReport report = simulation.step();
    expect_allowed(report.path);
    untangled = untangled || has(report.path, SolveStage::untangle);
    if (report.inverted_elements == 0) break;
  }
  EXPECT_TRUE(untangled || simulation.state().inverted_steps == 0);
}

TEST(SolvePath, OfAnEquilibriumCountsItsCuts) {
  Simulation simulation = hanging_bar("compliance_m_n: 0");
  simulation.set_command("cable", 0.5);
  const SolveReport report = simulation.solve_equilibrium();
  expect_allowed(report.path);
  EXPECT_TRUE(has(report.path, SolveStage::halving)) << text_of(report.path);
}

TEST(SolvePath, CountsOnWhereAStageGoesOn) {
  std::vector<SolvePathStage> path;
  enter(SolveStage::newton, 3, path);
  enter(SolveStage::newton, 2, path);
  enter(SolveStage::halving, 1, path);
  EXPECT_EQ(text_of(path), "newton 5, halving 1");
}

TEST(SolvePath, StaysShort) {
  std::vector<SolvePathStage> path;
  for (int i = 0; i < 200; ++i) enter(i % 2 == 0 ? SolveStage::newton : SolveStage::halving, 1, path);
  ASSERT_EQ(path.size(), kLongestPath + 1);
  EXPECT_EQ(path.back().stage, SolveStage::more);
  EXPECT_EQ(path.back().count, 100);
  expect_allowed(path);
}

}  // namespace
}  // namespace soft_robot_lab
