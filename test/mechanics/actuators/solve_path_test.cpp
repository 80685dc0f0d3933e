// SPDX-License-Identifier: BSD-3-Clause
// The way that a solve reports.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
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
  for (Eigen::Index node = 0; node < state.positions_m.cols(); ++node)
    if (state.positions_m(1, node) < -0.09) state.positions_m(1, node) += 0.05;  // the tip into the middle
  state.inverted_steps = 1;
  simulation.set_state(state);
  const SolveReport report = simulation.step();
  expect_allowed(report.path);
  ASSERT_TRUE(has(report.path, SolveStage::untangle)) << text_of(report.path);
  EXPECT_EQ(report.path.front().stage, SolveStage::untangle);
  EXPECT_GT(report.path.front().count, 0);
  EXPECT_EQ(report.inverted_elements, 0);
}

int count_of(const std::vector<SolvePathStage>& path, SolveStage stage) {
  int count = 0;
  for (const SolvePathStage& at : path) count += at.stage == stage ? at.count : 0;
  return count;
}

// A bar whose cable is pulled at once, and the step in which a rescue is needed.
struct HardPull {
  SolveStage rescue;
  std::string cable;
  double command;
  int steps;
  int max_iterations = 100;
  double tolerance = 1e-4;
};

SolveReport last_step_of(const HardPull& pull) {
  SolverOptions options;
  options.max_iterations = pull.max_iterations;
  options.dynamic_tolerance = pull.tolerance;
  Simulation simulation = hanging_bar(pull.cable, options);
  simulation.set_command("cable", pull.command);
  for (int step = 1; step < pull.steps; ++step) simulation.step();
  return simulation.step();
}

TEST(SolvePath, NamesEachRescueOfATimeStep) {
  const HardPull table[] = {{SolveStage::line_search, "compliance_m_n: 0", 0.7, 2},
                            {SolveStage::convexify, "compliance_m_n: 0", 0.7, 2},
                            {SolveStage::energy_descent, "compliance_m_n: 0", 0.5, 1},
                            {SolveStage::halving, "model: friction, friction_coefficient: 0.3", 0.5, 1},
                            {SolveStage::last_resort, "compliance_m_n: 0", 0.8, 1, 1, 1e-12}};
  for (const HardPull& pull : table) {
    SCOPED_TRACE(name_of(pull.rescue));
    const SolveReport report = last_step_of(pull);
    expect_allowed(report.path);
    EXPECT_TRUE(has(report.path, pull.rescue)) << text_of(report.path);
    EXPECT_EQ(report.converged, pull.rescue != SolveStage::last_resort) << text_of(report.path);
    // Nothing is done that is not listed.
    EXPECT_EQ(count_of(report.path, SolveStage::newton) + count_of(report.path, SolveStage::energy_descent),
              report.iterations);
    EXPECT_GE(report.rejected_steps,
              count_of(report.path, SolveStage::line_search) + count_of(report.path, SolveStage::convexify));
  }
}

// Friction has no energy to descend along.
TEST(SolvePath, OfAnEquilibriumWithFrictionGoesOnInArtificialTime) {
  SolverOptions options;
  options.max_iterations = 2;
  Simulation simulation = hanging_bar("model: friction, friction_coefficient: 0.3", options);
  simulation.set_command("cable", 0.9);
  const SolveReport report = simulation.solve_equilibrium();
  expect_allowed(report.path);
  EXPECT_TRUE(has(report.path, SolveStage::pseudo_transient)) << text_of(report.path);
  EXPECT_FALSE(has(report.path, SolveStage::energy_descent)) << text_of(report.path);
}

// A column buckles under its weight, which comes slowly once it was too much at once.
TEST(SolvePath, OfAnEquilibriumFallsInArtificialTimeWhereTheShapeIsLost) {
  Body body(box_mesh({0, 0, 0}, {0.01, 0.1, 0.01}, {1, 8, 1}), Material{264200.0, 0.49, 1070.0});
  body.fix_nodes({-10, -10, -10}, {10, 1e-6, 10}, {true, true, true});
  body.set_gravity({0.01, -40.0, 0});
  Simulation simulation(std::move(body), {}, {}, {});
  const SolveReport report = simulation.solve_equilibrium();
  EXPECT_TRUE(report.converged);
  expect_allowed(report.path);
  EXPECT_TRUE(has(report.path, SolveStage::halving)) << text_of(report.path);
  EXPECT_TRUE(has(report.path, SolveStage::pseudo_transient)) << text_of(report.path);
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

// Where a factor does not turn with the nodes this takes 21.
TEST(SolvePath, AFactorServesWhileABarBends) {
  Simulation simulation = hanging_bar("compliance_m_n: 1.0e-6");
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  int factorisations = 0;
  for (int i = 0; i < 60; ++i) {
    simulation.set_command("cable", 0.9 + 0.1 * std::cos(0.1 * i));
    const SolveReport report = simulation.step();
    ASSERT_TRUE(report.converged);
    factorisations += report.factorisations;
  }
  EXPECT_LE(factorisations, 13);
}

}  // namespace
}  // namespace soft_robot_lab
