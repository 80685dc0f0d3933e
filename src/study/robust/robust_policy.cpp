// SPDX-License-Identifier: BSD-3-Clause
#include "robust_policy.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "control/pose_problem.h"
#include "settings/quantile.h"

namespace soft_robot_lab {
namespace {

constexpr double kAround = 0.15;  // of each range, in which the quantile is sought around the mean's commands
constexpr int kPopulation = 8;

// A robot, its model of commands behind play, and where its cameras see it.
class Seen {
 public:
  Seen(RandomRobot& robot, const std::vector<std::string>& markers, const std::vector<std::string>& names)
      : robot_(robot), model_(*robot.simulation, markers, names) {}

  Prediction predict(const Eigen::VectorXd& commands, bool with_derivatives) {
    DrivePlay play = robot_.play;
    const DriveEnds ends = play.go({commands.data(), commands.data() + commands.size()});
    const Eigen::VectorXd there =
        Eigen::Map<const Eigen::VectorXd>(ends.commands.data(), static_cast<Eigen::Index>(ends.commands.size()));
    Prediction seen = model_.predict(there, with_derivatives);
    for (Eigen::Index m = 0; m < seen.markers_m.cols(); ++m) {
      seen.markers_m.col(m) = robot_.measured_from_base * Eigen::Vector3d(seen.markers_m.col(m));
      if (with_derivatives)
        seen.marker_jacobian.middleRows<3>(3 * m) =
            (robot_.measured_from_base.linear() * seen.marker_jacobian.middleRows<3>(3 * m)).eval();
    }
    return seen;
  }

 private:
  RandomRobot& robot_;
  ForwardModel model_;
};

std::vector<Seen> all_seen(std::vector<RandomRobot>& robots, const Pose& pose, const std::vector<std::string>& names) {
  std::vector<Seen> seen;
  for (RandomRobot& robot : robots) seen.emplace_back(robot, markers_of(pose), names);
  return seen;
}

double distance_m(const Eigen::Matrix3Xd& markers_m, const Pose& pose) {
  double sum_m2 = 0.0, weights = 0.0;
  for (std::size_t k = 0; k < pose.goals.size(); ++k) {
    const MarkerGoal& goal = pose.goals[k];
    sum_m2 += goal.weight * (markers_m.col(static_cast<Eigen::Index>(k)) - goal.target_m).squaredNorm();
    weights += goal.weight;
  }
  return std::sqrt(sum_m2 / weights);
}

// The markers of all robots one after the other; of their tensions the largest.
Prediction stacked(std::vector<Seen>& all, const Eigen::VectorXd& commands, bool with_derivatives) {
  Prediction sum;
  for (std::size_t r = 0; r < all.size(); ++r) {
    const Prediction one = all[r].predict(commands, with_derivatives);
    const Eigen::Index goals = one.markers_m.cols(), first = static_cast<Eigen::Index>(r) * goals;
    if (r == 0) {
      sum = one;
      sum.markers_m.resize(3, goals * static_cast<Eigen::Index>(all.size()));
      if (with_derivatives)
        sum.marker_jacobian.resize(3 * goals * static_cast<Eigen::Index>(all.size()), commands.size());
    }
    sum.markers_m.middleCols(first, goals) = one.markers_m;
    if (with_derivatives) sum.marker_jacobian.middleRows(3 * first, 3 * goals) = one.marker_jacobian;
    for (Eigen::Index i = 0; r > 0 && i < sum.tensions_n.size(); ++i) {
      if (one.tensions_n[i] <= sum.tensions_n[i]) continue;
      sum.tensions_n[i] = one.tensions_n[i];
      if (with_derivatives) sum.tension_jacobian.row(i) = one.tension_jacobian.row(i);
    }
  }
  return sum;
}

ReachProblem mean_problem(std::vector<Seen>& seen, ReachProblem problem) {
  const std::vector<Goal> goals = problem.goals;
  for (std::size_t r = 1; r < seen.size(); ++r) problem.goals.insert(problem.goals.end(), goals.begin(), goals.end());
  problem.model = [&seen](const Eigen::VectorXd& commands, bool with_derivatives) {
    return stacked(seen, commands, with_derivatives);
  };
  return problem;
}

// One marker that lies as far from its target as the quantile of all distances: what the methods take least squares of.
ReachProblem quantile_problem(std::vector<Seen>& seen, ReachProblem problem, const Pose& pose, double fraction,
                              const Eigen::VectorXd& around) {
  const Eigen::VectorXd reach = kAround * (problem.max - problem.min);
  problem.start = around;
  problem.min = problem.min.cwiseMax(around - reach);
  problem.max = problem.max.cwiseMin(around + reach);
  problem.goals = {{Eigen::Vector3d::Zero(), 1.0}};
  problem.model = [&seen, pose, fraction](const Eigen::VectorXd& commands, bool) {
    const Prediction all = stacked(seen, commands, false);
    const auto goals = static_cast<Eigen::Index>(pose.goals.size());
    std::vector<double> distances;
    for (Eigen::Index first = 0; first < all.markers_m.cols(); first += goals)
      distances.push_back(distance_m(all.markers_m.middleCols(first, goals), pose));
    Prediction one;
    one.markers_m = Eigen::Vector3d(quantile(distances, fraction), 0.0, 0.0);
    one.tensions_n = all.tensions_n;
    return one;
  };
  return problem;
}

}  // namespace

std::vector<double> distances_m(std::vector<RandomRobot>& robots, const CommandPolicy& policy, const Pose& pose) {
  std::vector<double> distances;
  for (RandomRobot& robot : robots) {
    const SimulationState before = robot.simulation->state();
    DrivePlay play = robot.play;
    CommandPolicy behind = policy;
    for (TimedCommandValues& step : behind.steps) step.values = play.go(step.values).commands;
    try {
      Eigen::Matrix3Xd markers_m = replay(*robot.simulation, behind, markers_of(pose)).back();
      for (Eigen::Index m = 0; m < markers_m.cols(); ++m)
        markers_m.col(m) = robot.measured_from_base * Eigen::Vector3d(markers_m.col(m));
      distances.push_back(distance_m(markers_m, pose));
    } catch (const ForwardModelError&) {
      distances.push_back(std::numeric_limits<double>::infinity());
    }
    robot.simulation->set_state(before);
  }
  return distances;
}

PolicyAnswer find_robust_policy(std::vector<RandomRobot>& robots, const PolicyTask& task, const RobustOptions& options,
                                const ProgressCallback& progress) {
  if (robots.empty()) throw std::invalid_argument("robots: none is given");
  if (task.poses.size() != 1) throw std::invalid_argument("a robust policy is found for one pose, not for a path");
  if (options.quantile && !(*options.quantile > 0.0 && *options.quantile < 1.0))
    throw std::invalid_argument("quantile " + std::to_string(*options.quantile) + " is out of range (0, 1)");
  const Simulation& first = *robots.front().simulation;
  require_task(first, task);
  const Pose& pose = task.poses.front();
  const ReachProblem one = pose_problem(first, task, pose);
  if (one.names.size() != first.actuators().size()) throw std::invalid_argument("a robust policy moves all actuators");
  std::vector<Seen> seen = all_seen(robots, pose, one.names);
  OptimisationSummary summary = optimise(mean_problem(seen, one), options.optimiser, progress);
  if (options.quantile && summary.usable) {
    OptimiserOptions search = options.optimiser;
    search.method = "cma_es";
    search.population = kPopulation;
    search.max_iterations = options.generations;
    const OptimisationSummary better =
        optimise(quantile_problem(seen, one, pose, *options.quantile, summary.commands), search, progress);
    if (better.usable) summary = better;
  }
  PolicyAnswer answer;
  answer.success = summary.usable;
  answer.policy.names = one.names;
  answer.policy.steps = {
      {pose.duration_s, {summary.commands.data(), summary.commands.data() + summary.commands.size()}}};
  answer.summaries = {summary};
  return answer;
}

}  // namespace soft_robot_lab
