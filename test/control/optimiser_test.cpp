// SPDX-License-Identifier: BSD-3-Clause
// The methods on closed-form robots: a planar arc that two cables bend, and a linear map.
#include "soft_robot_lab/control/optimiser.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "control/search.h"
#include "soft_robot_lab/control/forward_model.h"

namespace soft_robot_lab {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

using OneMarker = std::function<Eigen::Vector3d(const Eigen::VectorXd& commands, Eigen::Matrix3Xd* jacobian)>;

// The model of a single marker.
PredictionFunction model_of(const OneMarker& marker) {
  return [marker](const Eigen::VectorXd& commands, bool with_derivatives) {
    Prediction prediction;
    Eigen::Matrix3Xd jacobian;
    prediction.markers_m = marker(commands, with_derivatives ? &jacobian : nullptr);
    prediction.marker_jacobian = jacobian;
    return prediction;
  };
}

// The tip of an inextensible arc of 100 mm in x, y whose angle is 2 rad per unit of difference between two
// contractions, and which sinks 10 mm in z per unit of their mean: every tip is (l sin a / a, l (1 - cos a) / a, z).
struct Arc {
  double length_m = 0.1;
  double rad_per_command = 4.0;
  double z_m_per_command = 0.02;

  Eigen::Vector3d tip(double angle, double sum) const {
    const double x = std::abs(angle) < 1e-6 ? 1.0 - angle * angle / 6.0 : std::sin(angle) / angle;
    const double y = std::abs(angle) < 1e-6 ? angle / 2.0 : (1.0 - std::cos(angle)) / angle;
    return {length_m * x, length_m * y, z_m_per_command * sum};
  }
  Eigen::Vector3d operator()(const Eigen::VectorXd& commands, Eigen::Matrix3Xd* jacobian) const {
    const double a = rad_per_command * (commands[1] - commands[0]);
    if (jacobian) {
      const double dx = std::abs(a) < 1e-4 ? -a / 3.0 : (a * std::cos(a) - std::sin(a)) / (a * a);
      const double dy = std::abs(a) < 1e-4 ? 0.5 - a * a / 8.0 : (a * std::sin(a) - 1.0 + std::cos(a)) / (a * a);
      jacobian->resize(3, 2);
      jacobian->col(1) =
          Eigen::Vector3d(length_m * dx * rad_per_command, length_m * dy * rad_per_command, z_m_per_command);
      jacobian->col(0) = -jacobian->col(1);
      (*jacobian)(2, 0) = z_m_per_command;
    }
    return tip(a, commands.sum());
  }
};

ReachProblem arc_problem(const Eigen::Vector2d& goal_commands) {
  ReachProblem problem;
  problem.model = model_of(Arc());
  problem.goals = {Goal{Arc()(goal_commands, nullptr)}};
  problem.start = Eigen::Vector2d(1.0, 1.0);
  problem.min = Eigen::Vector2d(0.7, 0.7);
  problem.max = Eigen::Vector2d(1.0, 1.0);
  problem.names = {"left", "right"};
  return problem;
}

OptimiserOptions method(const std::string& name) {
  OptimiserOptions options;
  options.method = name;
  return options;
}

// Records every command that a method asks the model for.
ReachProblem recording(ReachProblem problem, std::vector<Eigen::VectorXd>& asked) {
  const PredictionFunction model = problem.model;
  problem.model = [model, &asked](const Eigen::VectorXd& commands, bool with_derivatives) {
    asked.push_back(commands);
    return model(commands, with_derivatives);
  };
  return problem;
}

TEST(GaussNewton, FindsTheCommandsOfAReachableTarget) {
  const Eigen::Vector2d goal(0.78, 0.93);
  const OptimisationSummary summary = optimise(arc_problem(goal), method("gauss_newton"));
  EXPECT_TRUE(summary.usable);
  EXPECT_TRUE(summary.target_reached);
  EXPECT_EQ(summary.stop_reason, "converged");
  EXPECT_TRUE(summary.active_limits.empty());
  EXPECT_LT(summary.final_distance_m, 1e-5);
  EXPECT_LT((summary.commands - goal).norm(), 1e-3);
  EXPECT_LE(summary.iterations, 25);
  EXPECT_LE(summary.evaluations, 30);
}

TEST(GaussNewton, StopsAtTheLimitsThatKeepItFromTheTarget) {
  // Twice as far round the arc as the bounds allow: the nearest reachable tip has left pulled fully and right slack.
  ReachProblem problem = arc_problem({0.4, 1.0});
  problem.goals[0].target_m.z() = Arc()(Eigen::Vector2d(0.7, 1.0), nullptr).z();
  const OptimisationSummary summary = optimise(problem, method("gauss_newton"));
  EXPECT_TRUE(summary.usable);
  EXPECT_FALSE(summary.target_reached);
  EXPECT_EQ(summary.stop_reason, "converged");
  EXPECT_NEAR(summary.commands[0], 0.7, 1e-6);
  EXPECT_NEAR(summary.commands[1], 1.0, 1e-6);
  EXPECT_EQ(summary.active_limits, (std::vector<std::string>{"left at its minimum 0.7", "right at its maximum 1"}));
}

// A bound that stops one command changes what is best for the other, because both pull the marker along x.
TEST(GaussNewton, FindsTheBestFreeCommandBesideABoundOne) {
  Eigen::Matrix<double, 3, 2> map;
  map << 0.1, 0.09, 0.0, 0.02, 0.0, 0.0;
  ReachProblem problem = arc_problem({1.0, 1.0});
  problem.model = model_of([map](const Eigen::VectorXd& commands, Eigen::Matrix3Xd* jacobian) -> Eigen::Vector3d {
    if (jacobian) *jacobian = map;
    return map * commands;
  });
  problem.min = Eigen::Vector2d(0.0, 0.0);
  problem.start = Eigen::Vector2d(0.5, 0.5);
  problem.goals[0].target_m = map * Eigen::Vector2d(1.4, 0.3);
  const OptimisationSummary summary = optimise(problem, method("gauss_newton"));
  const Eigen::Vector3d left_over = problem.goals[0].target_m - map.col(0);
  const double best_right = map.col(1).dot(left_over) / map.col(1).squaredNorm();
  EXPECT_NEAR(summary.commands[0], 1.0, 1e-6);
  EXPECT_NEAR(summary.commands[1], best_right, 2e-3);
  EXPECT_EQ(summary.active_limits, (std::vector<std::string>{"left at its maximum 1"}));
}

// Two cables that are slack at first: each does nothing above its own command, where its derivative is zero.
TEST(GaussNewton, PullsCablesThatAreSlackAtTheStart) {
  ReachProblem problem = arc_problem({1.0, 1.0});
  const PredictionFunction markers = model_of([](const Eigen::VectorXd& commands, Eigen::Matrix3Xd* jacobian) {
    const double left = std::max(0.0, 0.98 - commands[0]), right = std::max(0.0, 0.85 - commands[1]);
    if (jacobian) {
      jacobian->setZero(3, 2);
      if (left > 0.0) jacobian->col(0) = Eigen::Vector3d(0.0, -0.2, 0.05);
      if (right > 0.0) jacobian->col(1) = Eigen::Vector3d(0.0, 0.1, 0.05);
    }
    return Eigen::Vector3d(0.1, 0.2 * left - 0.1 * right, -0.05 * left - 0.05 * right);
  });
  problem.model = [markers](const Eigen::VectorXd& commands, bool with_derivatives) {
    Prediction prediction = markers(commands, with_derivatives);
    prediction.slack = (commands - Eigen::Vector2d(0.98, 0.85)).cwiseMax(0.0);
    return prediction;
  };
  problem.goals[0].target_m = problem.model(Eigen::Vector2d(0.8, 0.75), false).markers_m.col(0);
  const OptimisationSummary summary = optimise(problem, method("gauss_newton"));
  EXPECT_TRUE(summary.target_reached) << summary.stop_reason;
  EXPECT_LT((summary.commands - Eigen::Vector2d(0.8, 0.75)).norm(), 1e-3);
}

TEST(GaussNewton, EndsWhereNoCommandDoesAnything) {
  ReachProblem problem = arc_problem({0.8, 0.9});
  problem.model = model_of([](const Eigen::VectorXd&, Eigen::Matrix3Xd* jacobian) {
    if (jacobian) jacobian->setZero(3, 2);
    return Eigen::Vector3d(0.1, 0.0, 0.0);
  });
  const OptimisationSummary summary = optimise(problem, method("gauss_newton"));
  EXPECT_EQ(summary.stop_reason, "converged");
  EXPECT_TRUE(summary.usable);
  EXPECT_EQ(summary.commands, problem.start);
  EXPECT_LE(summary.evaluations, 100);  // they cost nothing where nothing moves
}

// y = 0.1 p + 2 p^2 for a pull p = 1 - left: the slope at the start promises too little, so the first step goes too
// far.
TEST(GaussNewton, GoesOnWhereTheModelFailsBeyondAPoint) {
  ReachProblem problem = arc_problem({1.0, 1.0});
  int failures = 0;
  problem.model = model_of([&failures](const Eigen::VectorXd& commands, Eigen::Matrix3Xd* jacobian) {
    const double pull = 1.0 - commands[0];
    if (pull > 0.16) {
      ++failures;
      throw ForwardModelError("buckled");
    }
    if (jacobian) *jacobian = Eigen::Vector3d(0.0, -0.1 - 4.0 * pull, 0.0) * Eigen::RowVector2d(1.0, 0.0);
    return Eigen::Vector3d(0.0, 0.1 * pull + 2.0 * pull * pull, 0.0);
  });
  problem.goals[0].target_m = {0.0, 0.06, 0.0};
  problem.min[0] = -9.0;  // so far away that no step is cut short
  const OptimisationSummary summary = optimise(problem, method("gauss_newton"));
  EXPECT_GT(failures, 0);
  EXPECT_TRUE(summary.target_reached) << summary.stop_reason;
  EXPECT_NEAR(summary.commands[0], 0.85, 1e-4);
}

// Long steps are answered half a millimetre beside the truth.
TEST(GaussNewton, EndsOnAnExactAnswerWhereTrialsAreRough) {
  for (const Eigen::Vector2d& goal :
       {Eigen::Vector2d(0.78, 0.93), Eigen::Vector2d(0.5, 0.9)}) {  // within reach, and not
    ReachProblem problem = arc_problem(goal);
    const OptimisationSummary exact = optimise(problem, method("gauss_newton"));
    int rough = 0;
    problem.trial = [&, last = problem.start](const Eigen::VectorXd& commands, bool with_derivatives) mutable {
      Prediction prediction = problem.model(commands, with_derivatives);
      if ((commands - last).norm() > 0.01) {
        ++rough;
        prediction.markers_m.col(0).y() += 5e-4;
      }
      if (with_derivatives) last = commands;
      return prediction;
    };
    const OptimisationSummary summary = optimise(problem, method("gauss_newton"));
    EXPECT_GT(rough, 0);
    EXPECT_LT(summary.final_distance_m, exact.final_distance_m + 1e-6);
    EXPECT_EQ((problem.model(summary.commands, false).markers_m - summary.markers_m).norm(), 0.0);
  }
}

TEST(Rmsprop, DescendsAndComesNearTheTarget) {
  const OptimisationSummary summary = optimise(arc_problem({0.85, 0.95}), method("rmsprop"));
  EXPECT_TRUE(summary.usable);
  EXPECT_EQ(summary.stop_reason, "iteration limit");
  EXPECT_EQ(summary.iterations, 1000);
  EXPECT_EQ(summary.evaluations, 1 + 1000 * 3);  // the point and a difference for each command
  EXPECT_LT(summary.final_distance_m, 0.1 * summary.initial_distance_m);
}

// One command that moves the marker along a line, 0.1 m per unit.
ReachProblem line_problem() {
  ReachProblem problem = arc_problem({1.0, 1.0});
  problem.names = {"left"};
  problem.start = Eigen::VectorXd::Constant(1, 0.9);
  problem.min = Eigen::VectorXd::Constant(1, 0.5);
  problem.max = Eigen::VectorXd::Constant(1, 1.0);
  problem.goals[0].target_m = {0.05, 0.0, 0.0};
  problem.model = model_of(
      [](const Eigen::VectorXd& commands, Eigen::Matrix3Xd*) { return Eigen::Vector3d(0.1 * commands[0], 0.0, 0.0); });
  return problem;
}

// The first step by hand: g = J^T (x - y) for small differences, E = 0.1 g^2, step 0.001 g / sqrt(E + 1e-6).
TEST(Rmsprop, TakesThePublishedStep) {
  const ReachProblem problem = line_problem();
  OptimiserOptions options = method("rmsprop");
  options.max_iterations = 1;
  Eigen::VectorXd after;
  optimise(problem, options, [&](const OptimisationProgress& progress) {
    after = progress.commands;
    return true;
  });
  const auto objective = [](double command) { return 0.5 * std::pow(0.05 - 0.1 * command, 2); };
  const double slope = (objective(0.9) - objective(0.899)) / 0.001;
  ASSERT_EQ(after.size(), 1);
  EXPECT_NEAR(after[0], 0.9 - 0.001 * slope / std::sqrt(0.1 * slope * slope + 1e-6), 1e-12);
}

TEST(Rmsprop, StopsWhereEveryDerivativeIsBelowItsToleranceIfOneIsGiven) {
  OptimiserOptions options = method("rmsprop");
  options.gradient_tolerance_m2 = 1e-4;
  const OptimisationSummary summary = optimise(line_problem(), options);
  EXPECT_EQ(summary.stop_reason, "converged");
  EXPECT_LT(summary.iterations, 1000);
  // The derivative is 0.1 times the distance on this line; a step of at most 0.0032 a command before it was larger.
  EXPECT_LT(0.1 * summary.final_distance_m, 1e-4);
  EXPECT_GT(0.1 * summary.final_distance_m, 1e-4 - 0.1 * 0.1 * 0.0033);
}

class EveryMethod : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Optimiser, EveryMethod, testing::ValuesIn(optimiser_methods()));

TEST_P(EveryMethod, AsksOnlyForCommandsWithinTheBounds) {
  std::vector<Eigen::VectorXd> asked;
  for (const Eigen::Vector2d& start :
       {Eigen::Vector2d(1.0, 1.0), Eigen::Vector2d(0.7, 0.7), Eigen::Vector2d(0.7, 1.0)}) {
    ReachProblem problem = recording(arc_problem({0.3, 1.2}), asked);
    problem.start = start;
    optimise(problem, method(GetParam()), [&](const OptimisationProgress& now) {
      asked.push_back(now.commands);  // an iterate
      return true;
    });
  }
  ASSERT_GT(asked.size(), 5u);
  for (const Eigen::VectorXd& commands : asked) {
    EXPECT_GE(commands.minCoeff(), 0.7);
    EXPECT_LE(commands.maxCoeff(), 1.0);
  }
}

TEST_P(EveryMethod, IsNeverWorseThanItsStart) {
  for (const double left : {0.7, 0.8, 0.9, 1.0}) {
    ReachProblem problem = arc_problem({left, 0.9});
    problem.start = Eigen::Vector2d(left, 0.9001);
    const OptimisationSummary summary = optimise(problem, method(GetParam()));
    EXPECT_TRUE(summary.usable);
    EXPECT_LE(summary.final_distance_m, summary.initial_distance_m);
    EXPECT_DOUBLE_EQ(summary.final_distance_m, (problem.goals[0].target_m - summary.markers_m.col(0)).norm());
  }
}

TEST_P(EveryMethod, TellsWhyItCannotStart) {
  ReachProblem problem = arc_problem({0.8, 1.0});
  problem.model = model_of([](const Eigen::VectorXd&, Eigen::Matrix3Xd*) -> Eigen::Vector3d {
    throw ForwardModelError("residual 0.3 after 60 iterations");
  });
  const OptimisationSummary summary = optimise(problem, method(GetParam()));
  EXPECT_FALSE(summary.usable);
  EXPECT_FALSE(summary.target_reached);
  EXPECT_EQ(summary.stop_reason, "no equilibrium at left 1, right 1: residual 0.3 after 60 iterations");
  EXPECT_EQ(summary.commands, problem.start);
  EXPECT_EQ(summary.evaluations, 1);
}

TEST_P(EveryMethod, TakesAnAnswerThatIsNotANumberForAFailure) {
  ReachProblem problem = arc_problem({0.8, 1.0});
  problem.model = model_of([](const Eigen::VectorXd&, Eigen::Matrix3Xd* jacobian) {
    if (jacobian) *jacobian = Eigen::Matrix3Xd::Zero(3, 2);
    return Eigen::Vector3d(0.0, kNan, 0.0);
  });
  const OptimisationSummary summary = optimise(problem, method(GetParam()));
  EXPECT_FALSE(summary.usable);
  EXPECT_NE(summary.stop_reason.find("not finite"), std::string::npos);
}

TEST_P(EveryMethod, TellsEveryIterationAndStopsWhenAsked) {
  std::vector<OptimisationProgress> reported;
  const OptimisationSummary summary =
      optimise(arc_problem({0.72, 0.98}), method(GetParam()), [&](const OptimisationProgress& progress) {
        reported.push_back(progress);
        return progress.iteration < 2;
      });
  EXPECT_EQ(summary.stop_reason, "cancelled");
  EXPECT_TRUE(summary.usable);
  EXPECT_EQ(summary.iterations, 2);
  ASSERT_EQ(reported.size(), 2u);
  EXPECT_EQ(reported[0].iteration, 1);
  for (const OptimisationProgress& progress : reported) {
    const Eigen::Vector3d tip = Arc()(progress.commands, nullptr);
    EXPECT_NEAR(progress.distance_m, (tip - arc_problem({0.72, 0.98}).goals[0].target_m).norm(), 1e-12);
  }
}

TEST_P(EveryMethod, StopsAtTheIterationLimit) {
  OptimiserOptions options = method(GetParam());
  options.max_iterations = 1;
  options.tolerance_m = 1e-12;
  const OptimisationSummary summary = optimise(arc_problem({0.72, 0.98}), options);
  EXPECT_EQ(summary.stop_reason, "iteration limit");
  EXPECT_EQ(summary.iterations, 1);
}

TEST(Rmsprop, EndsAtAFailureWithTheBestSoFar) {
  ReachProblem problem = arc_problem({0.72, 1.0});
  problem.model = model_of([arc = Arc()](const Eigen::VectorXd& commands, Eigen::Matrix3Xd* jacobian) {
    if (commands[0] < 0.9) throw ForwardModelError("buckled");
    return arc(commands, jacobian);
  });
  const OptimisationSummary summary = optimise(problem, method("rmsprop"));
  EXPECT_NE(summary.stop_reason.find("buckled"), std::string::npos);
  EXPECT_TRUE(summary.usable);
  EXPECT_LT(summary.final_distance_m, summary.initial_distance_m);
}

TEST(Optimiser, MeasuresItsTime) {
  const OptimisationSummary summary = optimise(arc_problem({0.8, 0.9}), method("rmsprop"));
  EXPECT_GT(summary.cpu_s, 0.0);
  EXPECT_LT(summary.cpu_s, summary.wall_s + 0.02);
}

// Every derivative that a method may use, against central differences: markers with weights, effort, and tensions in
// the last part of their limits.
TEST(Search, KnowsTheDerivativeOfEveryResidual) {
  ReachProblem problem = arc_problem({0.8, 0.9});
  problem.goals = {Goal{{0.05, 0.06, 0.0}, 3.0}, Goal{{0.09, 0.0, 0.01}, 1.0}};
  problem.rest = Eigen::Vector2d(1.0, 1.0);
  problem.effort_m = 0.02;
  problem.max_tension_n = Eigen::Vector2d(5.0, 5.0);
  problem.model = [](const Eigen::VectorXd& commands, bool with_derivatives) {
    Prediction prediction;
    Eigen::Matrix3Xd jacobian;
    const Eigen::Vector3d tip = Arc()(commands, &jacobian);
    prediction.markers_m.resize(3, 2);
    prediction.markers_m << tip, 0.5 * tip;
    prediction.tensions_n = 4.95 * Eigen::Vector2d::Ones() + 0.1 * (commands - Eigen::Vector2d(0.85, 0.9));
    if (with_derivatives) {
      prediction.marker_jacobian.resize(6, 2);
      prediction.marker_jacobian << jacobian, 0.5 * jacobian;
      prediction.tension_jacobian = 0.1 * Eigen::Matrix2d::Identity();
    }
    return prediction;
  };
  Search search(problem, ProgressCallback());
  const Eigen::Vector2d at(0.86, 0.91);
  const Evaluation here = *search.evaluate(at, true);
  ASSERT_EQ(here.residuals.size(), 10);
  EXPECT_GT(here.residuals.tail(2).minCoeff(), 0.0);
  EXPECT_TRUE(here.allowed);
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector2d step = 1e-6 * Eigen::Vector2d::Unit(i);
    const Eigen::VectorXd there = search.evaluate(at + step, false)->residuals;
    const Eigen::VectorXd back = search.evaluate(at - step, false)->residuals;
    EXPECT_LT((here.jacobian.col(i) - (there - back) / 2e-6).norm(), 1e-6 * here.jacobian.norm());
  }
}

// A stiff cable: 40 N per unit of pull, so that the arc's target lies beyond 6 N.
ReachProblem tense_problem() {
  ReachProblem problem = arc_problem({0.75, 1.0});
  problem.max_tension_n = Eigen::Vector2d(6.0, 6.0);
  problem.model = [](const Eigen::VectorXd& commands, bool with_derivatives) {
    Prediction prediction;
    Eigen::Matrix3Xd jacobian;
    prediction.markers_m = Arc()(commands, &jacobian);
    prediction.tensions_n = 40.0 * (Eigen::Vector2d::Ones() - commands);
    if (with_derivatives) {
      prediction.marker_jacobian = jacobian;
      prediction.tension_jacobian = -40.0 * Eigen::Matrix2d::Identity();
    }
    return prediction;
  };
  return problem;
}

TEST_P(EveryMethod, EndsBelowTheLargestTension) {
  const OptimisationSummary summary = optimise(tense_problem(), method(GetParam()));
  EXPECT_TRUE(summary.usable);
  EXPECT_LE(40.0 * (1.0 - summary.commands.minCoeff()), 6.0);
  EXPECT_LT(summary.final_distance_m, summary.initial_distance_m);
}

TEST(GaussNewton, StopsNearTheLargestTension) {
  const OptimisationSummary summary = optimise(tense_problem(), method("gauss_newton"));
  EXPECT_EQ(summary.stop_reason, "converged");
  EXPECT_FALSE(summary.target_reached);
  EXPECT_GT(40.0 * (1.0 - summary.commands[0]), 0.98 * 6.0);
  EXPECT_EQ(summary.active_limits.front(), "left near its largest tension 6 N");
}

// Two targets for one marker: it rests where the weights balance.
TEST(GaussNewton, WeighsItsGoals) {
  ReachProblem problem = arc_problem({1.0, 1.0});
  Eigen::Matrix<double, 3, 2> map;
  map << 0.1, 0.0, 0.0, 0.1, 0.0, 0.0;
  problem.model = [map](const Eigen::VectorXd& commands, bool) {
    Prediction prediction;
    prediction.markers_m.resize(3, 2);
    prediction.markers_m << map * commands, map * commands;
    prediction.marker_jacobian.resize(6, 2);
    prediction.marker_jacobian << map, map;
    return prediction;
  };
  problem.goals = {Goal{{0.075, 0.09, 0.0}, 3.0}, Goal{{0.095, 0.09, 0.0}, 1.0}};
  const OptimisationSummary summary = optimise(problem, method("gauss_newton"));
  EXPECT_NEAR(summary.markers_m(0, 0), 0.08, 1e-5);
  EXPECT_NEAR(summary.final_distance_m, std::sqrt(0.75 * 0.005 * 0.005 + 0.25 * 0.015 * 0.015), 1e-7);
}

TEST(GaussNewton, TradesDistanceForEffort) {
  ReachProblem problem = arc_problem({0.75, 0.9});
  problem.rest = problem.start;
  const double free_pull = (problem.rest - optimise(problem, method("gauss_newton")).commands).norm();
  problem.effort_m = 0.05;
  const OptimisationSummary easier = optimise(problem, method("gauss_newton"));
  EXPECT_LT((problem.rest - easier.commands).norm(), 0.95 * free_pull);
  EXPECT_GT(easier.final_distance_m, 1e-4);
}

// A valley that turns: beside a target far out of reach J^T J alone needs hundreds of steps.
TEST(GaussNewton, LearnsTheCurvatureOfAValleyBesideATargetOutOfReach) {
  ReachProblem problem = arc_problem({1.0, 1.0});
  problem.min = Eigen::Vector2d(-1.0, -1.0);
  problem.max = Eigen::Vector2d(1.0, 1.0);
  problem.start = Eigen::Vector2d(-0.5, 0.5);
  problem.model = model_of([](const Eigen::VectorXd& c, Eigen::Matrix3Xd* jacobian) {
    const double off = c[1] - c[0] * c[0];
    if (jacobian) {
      jacobian->resize(3, 2);
      *jacobian << 0.1, 0.0, -2.0 * c[0], 1.0, -4.0 * off * c[0], 2.0 * off;
    }
    return Eigen::Vector3d(0.1 * c[0], off, off * off);
  });
  problem.goals = {Goal{{0.05, 0.0, -1.0}}};
  const OptimisationSummary summary = optimise(problem, method("gauss_newton"));
  EXPECT_EQ(summary.stop_reason, "converged");
  EXPECT_NEAR(summary.commands[0], 0.5, 3e-3);
  EXPECT_NEAR(summary.commands[1], 0.25, 3e-3);
}

TEST(PidProjected, ReachesAReachableTarget) {
  const OptimisationSummary summary = optimise(arc_problem({0.78, 0.93}), method("pid_projected"));
  EXPECT_TRUE(summary.target_reached) << summary.stop_reason << " " << summary.final_distance_m;
}

// Of n iterations from 0.9, with it.
std::vector<double> iterates(const ReachProblem& problem, OptimiserOptions options, int n) {
  options.max_iterations = n;
  std::vector<double> after = {problem.start[0]};
  optimise(problem, options, [&](const OptimisationProgress& progress) {
    after.push_back(progress.commands[0]);
    return true;
  });
  return after;
}

// A marker that a unit of command moves by so much. Kd |J|^2 is 150 metres squared: 1 at 82 mm.
ReachProblem line_of(double metres_per_command) {
  ReachProblem problem = line_problem();
  problem.model = model_of([metres_per_command](const Eigen::VectorXd& commands, Eigen::Matrix3Xd*) {
    return Eigen::Vector3d(metres_per_command * commands[0], 0.0, 0.0);
  });
  problem.goals[0].target_m = {metres_per_command * 0.8, 0.0, 0.0};
  return problem;
}

// The printed formula by hand, on the line: O(t) = 1/2 (0.048 - 0.06 a)^2, and the difference of x is 0.06 exactly. The
// commands are start + u, so of what the step before added nothing is left.
TEST(Pid, TakesThePublishedStep) {
  const std::vector<double> after = iterates(line_of(0.06), method("pid"), 4);
  ASSERT_EQ(after.size(), 5u);
  std::vector<double> o;
  for (const double a : after) o.push_back(0.5 * std::pow(0.048 - 0.06 * a, 2));
  const auto command = [&](std::size_t t, double integral) {
    return 0.9 + 0.05 * o[t] + 0.00075 * integral + 150.0 * (0.048 - 0.06 * after[t]) * 0.06;
  };
  EXPECT_NEAR(after[1], command(0, 0.0), 1e-12);
  EXPECT_NEAR(after[2], command(1, 1.0 / 6.0 * (o[0] + 4.0 * (o[0] + o[1]) / 2.0 + o[1])), 1e-12);
  EXPECT_NEAR(after[3], command(2, 2.0 / 6.0 * (o[0] + 4.0 * o[1] + o[2])), 1e-12);
  EXPECT_NEAR(after[4], command(3, 3.0 / 6.0 * (o[0] + 4.0 * (o[1] + o[2]) / 2.0 + o[3])), 1e-12);
}

TEST(Pid, SwingsWhereItsLoopGainExceedsOneAndRestsShortOfTheTargetElsewhere) {
  const std::vector<double> tame = iterates(line_of(0.06), method("pid"), 100);
  const double gain = 150.0 * 0.06 * 0.06;  // below 1: the fixed point of a = 0.9 + gain (0.8 - a)
  EXPECT_NEAR(tame.back(), (0.9 + gain * 0.8) / (1.0 + gain), 1e-4);
  EXPECT_NEAR(tame.back(), tame[tame.size() - 2], 1e-5);
  const std::vector<double> wild = iterates(line_of(0.1), method("pid"), 100);  // 1.5
  EXPECT_EQ(std::max(wild[99], wild[100]), 1.0);  // its bound, whence it falls to 0.9 + 1.5 (0.8 - 1)
  EXPECT_NEAR(std::min(wild[99], wild[100]), 0.6, 1e-4);
}

// Two valleys; the one that descent falls into is the worse.
TEST(CmaEs, FindsTheBetterOfTwoValleys) {
  ReachProblem problem = arc_problem({1.0, 1.0});
  problem.model = model_of([](const Eigen::VectorXd& c, Eigen::Matrix3Xd* jacobian) {
    if (jacobian) jacobian->setZero(3, 2);
    const double well =
        0.02 - 0.01 * std::exp(-400.0 * std::pow(c[0] - 0.95, 2)) - 0.02 * std::exp(-400.0 * std::pow(c[0] - 0.75, 2));
    return Eigen::Vector3d(well, c[1] - 0.9, 0.0);
  });
  problem.goals = {Goal{Eigen::Vector3d::Zero()}};
  const OptimisationSummary summary = optimise(problem, method("cma_es"));
  EXPECT_NEAR(summary.commands[0], 0.75, 1e-2);
  OptimiserOptions again = method("cma_es");
  EXPECT_EQ(optimise(problem, again).commands, summary.commands);  // the seed decides
}

struct Refused {
  const char* words;  // expected in the message
  std::function<void(ReachProblem&, OptimiserOptions&)> spoil;
};

TEST(Optimiser, RefusesWhatItCannotUse) {
  const double inf = std::numeric_limits<double>::infinity();
  const std::vector<Refused> table = {
      {"model: none is given", [](auto& p, auto&) { p.model = nullptr; }},
      {"target_m", [](auto& p, auto&) { p.goals[0].target_m.y() = kNan; }},
      {"start has no entries", [](auto& p, auto&) { p.start.resize(0); }},
      {"min has 1 entries, must have 2", [](auto& p, auto&) { p.min = Eigen::VectorXd::Zero(1); }},
      {"max has 3 entries, must have 2", [](auto& p, auto&) { p.max = Eigen::VectorXd::Ones(3); }},
      {"names has 1 entries, must have 2", [](auto& p, auto&) { p.names.pop_back(); }},
      {"min of right: nan must be finite", [](auto& p, auto&) { p.min[1] = kNan; }},
      {"max of left: inf must be finite", [inf](auto& p, auto&) { p.max[0] = inf; }},
      {"min of left: 1 must be below its max 1", [](auto& p, auto&) { p.min[0] = 1.0; }},
      {"start of left: 1.01 is out of range [0.7, 1]", [](auto& p, auto&) { p.start[0] = 1.01; }},
      {"start of right: nan is out of range [0.7, 1]", [](auto& p, auto&) { p.start[1] = kNan; }},
      {"method: 'newton' is not one of gauss_newton, rmsprop, pid, pid_projected",
       [](auto&, auto& o) { o.method = "newton"; }},
      {"max_iterations: -1 is out of range [0, 1000000]", [](auto&, auto& o) { o.max_iterations = -1; }},
      {"max_iterations: 1000001 is out of range", [](auto&, auto& o) { o.max_iterations = 1000001; }},
      {"tolerance_m: 0 is out of range (0, inf)", [](auto&, auto& o) { o.tolerance_m = 0.0; }},
      {"tolerance_m: inf is out of range (0, inf)", [inf](auto&, auto& o) { o.tolerance_m = inf; }},
      {"goals: none is given", [](auto& p, auto&) { p.goals.clear(); }},
      {"weight: 0 is out of range (0, inf)", [](auto& p, auto&) { p.goals[0].weight = 0.0; }},
      {"effort_m: -1 is out of range [0, inf)", [](auto& p, auto&) { p.effort_m = -1.0; }},
      {"rest has 0 entries, must have 2", [](auto& p, auto&) { p.effort_m = 1.0; }},
      {"max_tension_n of right: 0 is out of range (0, inf]",
       [](auto& p, auto&) { p.max_tension_n = Eigen::Vector2d(1.0, 0.0); }},
      {"gradient_tolerance_m2: -1 is out of range [0, inf)", [](auto&, auto& o) { o.gradient_tolerance_m2 = -1.0; }},
      {"gradient_tolerance_m2: nan is out", [](auto&, auto& o) { o.gradient_tolerance_m2 = kNan; }},
      {"population: 4 is out of range [5, 1000]", [](auto&, auto& o) { o.population = 4; }},
      {"tolerance_m: nan is out of range (0, inf)", [](auto&, auto& o) { o.tolerance_m = kNan; }},
  };
  for (const Refused& refused : table) {
    ReachProblem problem = arc_problem({0.8, 0.9});
    OptimiserOptions options;
    refused.spoil(problem, options);
    try {
      optimise(problem, options);
      ADD_FAILURE() << "accepted: " << refused.words;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(refused.words), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace soft_robot_lab
