// SPDX-License-Identifier: BSD-3-Clause
// The forward model, and the optimiser on it.
#include "soft_robot_lab/control/forward_model.h"

#include <string>

#include <gtest/gtest.h>

#include "cabled_bar.h"
#include "soft_robot_lab/control/optimiser.h"

namespace soft_robot_lab {
namespace {

TEST(ForwardModel, TakesCommandsInTheOrderOfItsNames) {
  Simulation simulation = bar();
  const Eigen::Vector2d left_pulled(0.95, 1.0);
  const Eigen::Vector3d one =
      ForwardModel(simulation, {"tip"}, {"left", "right"}).predict(left_pulled, false).markers_m;
  const Eigen::Vector3d other =
      ForwardModel(simulation, {"tip"}, {"right", "left"}).predict(left_pulled, false).markers_m;
  EXPECT_LT(one.y(), -0.005);
  EXPECT_NEAR(one.y(), -other.y(), 1e-3);
}

TEST(ForwardModel, KnowsItsDerivative) {
  SolverOptions options;
  options.tolerance = 1e-9;
  Simulation simulation = bar(options);
  ForwardModel model(simulation, {"tip", "middle"}, {"right", "left"});
  const Eigen::Vector2d at(0.97, 0.93);
  const Prediction here = model.predict(at, true);
  ASSERT_EQ(here.marker_jacobian.rows(), 6);
  ASSERT_EQ(here.marker_jacobian.cols(), 2);
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector2d step = 1e-4 * Eigen::Vector2d::Unit(i);
    const Prediction there = model.predict(at + step, false), back = model.predict(at - step, false);
    const Eigen::Matrix<double, 3, 2> markers = (there.markers_m - back.markers_m) / 2e-4;
    const Eigen::Map<const Eigen::VectorXd> slopes(markers.data(), 6);
    EXPECT_LT((here.marker_jacobian.col(i) - slopes).norm(), 1e-3 * here.marker_jacobian.norm());
    const Eigen::VectorXd tensions = (there.tensions_n - back.tensions_n) / 2e-4;
    EXPECT_LT((here.tension_jacobian.col(i) - tensions).norm(), 1e-3 * here.tension_jacobian.norm());
  }
  EXPECT_GT(here.tensions_n.minCoeff(), 0.0);
}

TEST(ForwardModel, RefusesUnknownNamesAndListsTheKnown) {
  Simulation simulation = bar();
  for (const auto& [marker, actuator, words] :
       {std::tuple("tipp", "left", "middle, tip"), std::tuple("tip", "top", "left, right")}) {
    try {
      ForwardModel(simulation, {marker}, {actuator});
      ADD_FAILURE() << marker << " " << actuator;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  }
}

TEST(ForwardModel, LeavesTheStateWhereARequestIsRefused) {
  Simulation simulation = bar();
  ForwardModel model(simulation, {"tip"}, {"left", "right"});
  model.predict(Eigen::Vector2d(0.97, 1.0), false);
  const SimulationState before = simulation.state();
  EXPECT_THROW(model.predict(Eigen::Vector2d(0.95, 7.0), false), std::invalid_argument);
  EXPECT_THROW(model.predict(Eigen::VectorXd::Ones(3), false), std::invalid_argument);
  EXPECT_EQ(simulation.state().commands(), before.commands());
  EXPECT_EQ(simulation.state().positions_m, before.positions_m);
}

TEST(ForwardModel, GoesBackToTheLastGoodStateWhereItFindsNoEquilibrium) {
  SolverOptions options;
  options.tolerance = 1e-300;  // nothing moves at rest, so that alone is met
  options.max_iterations = 3;
  Simulation simulation = bar(options);
  ForwardModel model(simulation, {"tip"}, {"left", "right"});
  const SimulationState before = simulation.state();
  EXPECT_THROW(model.predict(Eigen::Vector2d(0.9, 1.0), false), ForwardModelError);
  EXPECT_EQ(simulation.state().commands(), before.commands());
  EXPECT_EQ(simulation.state().actuated_commands(), before.actuated_commands());
  EXPECT_EQ(simulation.state().positions_m, before.positions_m);
}

// Pulled by both cables alike the bar buckles: there it is, but a search had better cut its step.
TEST(ForwardModel, RefusesATrialThatLeadsThroughBuckling) {
  Simulation simulation = bar();
  ForwardModel model(simulation, {"tip"}, {"left", "right"});
  model.predict(Eigen::Vector2d(1.0, 1.0), false);
  const SimulationState before = simulation.state();
  const Eigen::Vector2d buckled(0.85, 0.85);
  EXPECT_THROW(model.try_out(buckled, false), ForwardModelError);
  EXPECT_EQ(simulation.state().commands(), before.commands());
  EXPECT_EQ(simulation.state().positions_m, before.positions_m);
  EXPECT_NO_THROW(model.predict(buckled, false));
}

TEST(ForwardModel, AnswersAShortTrialExactlyAndALongOneRoughly) {
  SolverOptions options;
  options.tolerance = 1e-9;
  Simulation simulation = bar(options);
  ForwardModel model(simulation, {"tip"}, {"left", "right"});
  const Eigen::Vector2d near(0.999, 1.0), far(0.96, 1.0);
  const Eigen::Vector3d short_m = model.try_out(near, false).markers_m;
  EXPECT_EQ((model.predict(near, false).markers_m - short_m).norm(), 0.0);
  const Eigen::Vector3d rough_m = model.try_out(far, false).markers_m;
  EXPECT_EQ((model.try_out(far, true).markers_m - rough_m).norm(), 0.0);
  const double off_m = (model.predict(far, false).markers_m - rough_m).norm();
  EXPECT_GT(off_m, 0.0);
  EXPECT_LT(off_m, 1e-4);
}

TEST(GaussNewton, BringsTheTipToAReachableTarget) {
  Simulation simulation = bar();
  ForwardModel model(simulation, {"tip"}, {"left", "right"});
  const Eigen::Vector2d goal(0.92, 0.98);
  ReachProblem problem;
  problem.model = [&](const Eigen::VectorXd& commands, bool with_derivatives) {
    return model.predict(commands, with_derivatives);
  };
  problem.goals = {Goal{model.predict(goal, false).markers_m}};
  problem.start = problem.max = Eigen::Vector2d(1.0, 1.0);
  problem.min = Eigen::Vector2d(0.8, 0.8);
  problem.names = {"left", "right"};
  simulation.reset();
  const OptimisationSummary summary = optimise(problem, OptimiserOptions{});
  EXPECT_TRUE(summary.target_reached) << summary.stop_reason;
  EXPECT_LT((summary.commands - goal).norm(), 0.01);
  EXPECT_LE(summary.evaluations, 20);
}

}  // namespace
}  // namespace soft_robot_lab
