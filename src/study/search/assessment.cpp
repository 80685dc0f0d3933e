// SPDX-License-Identifier: BSD-3-Clause
#include "assessment.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/SVD>

#include "control/workspace/walk.h"
#include "soft_robot_lab/control/find_policy.h"
#include "study/workspace/workspace_plan.h"

namespace soft_robot_lab {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kStagesToReach = 8;

WorkspacePlan plan_of(const std::string& robot_file, const Simulation& robot, const AssessmentSettings& settings) {
  WorkspaceSettings grid;
  grid.robot = robot_file;
  grid.marker = settings.marker;
  grid.steps = settings.steps;
  for (const auto& actuator : robot.actuators()) {
    const CommandLimits& limits = actuator->limits();
    const bool pulls = limits.min < limits.rest;
    grid.range.emplace_back(actuator->name(), pulls ? limits.min : limits.rest, pulls ? limits.rest : limits.max);
  }
  return plan_workspace(grid, robot, "");
}

// Of each point whether it is asked for.
std::vector<bool> wanted_points(const WorkspacePlan& plan, const Simulation& robot, bool one_at_a_time) {
  std::vector<bool> wanted(plan.tasks.size(), true);
  for (std::size_t point = 0; one_at_a_time && point < wanted.size(); ++point) {
    int moved = 0;
    for (std::size_t i = 0; i < robot.actuators().size(); ++i)
      moved += plan.tasks[point].values[i] != robot.actuators()[i]->limits().rest;
    wanted[point] = moved <= 1;
  }
  return wanted;
}

std::vector<WorkspacePoint> walk(const WorkspacePlan& plan, const Simulation& robot, const std::vector<bool>& wanted) {
  std::vector<WorkspacePoint> points(plan.tasks.size());
  WorkspaceWalk walk{robot.model(), robot.marker_index(plan.marker), plan.commands, plan.starts, {}, 1, {}};
  walk.wanted = wanted;
  walk.found = [&](int point, const WorkspacePoint& found) {
    points[static_cast<std::size_t>(point)] = found;
    return true;
  };
  walk_workspace(walk);
  return points;
}

double tension_n(const WorkspacePoint& point) {
  double most_n = 0.0;
  for (const ActuatorReading& reading : point.actuators) most_n = std::max(most_n, reading.tension_n.value_or(0.0));
  return most_n;
}

// Of the parallelepiped that the marker spans where each command changes by one.
double size_of(const Eigen::MatrixXd& jacobian_m) {
  const Eigen::VectorXd values = jacobian_m.jacobiSvd().singularValues();
  return values.head(std::min<Eigen::Index>(3, values.size())).prod();
}

// By stages, as a body may buckle.
void go_to(Simulation& robot, const Eigen::VectorXd& commands) {
  const std::vector<double> from = robot.state().commands();
  for (int stage = 1; stage <= kStagesToReach; ++stage) {
    const double fraction = static_cast<double>(stage) / kStagesToReach;
    for (std::size_t i = 0; i < from.size(); ++i)
      robot.set_command(robot.actuators()[i]->name(),
                        from[i] + fraction * (commands[static_cast<Eigen::Index>(i)] - from[i]));
    if (const SolveReport report = robot.solve_equilibrium(); !report.converged)
      throw std::runtime_error("no rest state on the way to the farthest place: " + report.message);
  }
}

double stiffness_sensitivity_m(Simulation& robot, int marker, const Eigen::VectorXd& commands) {
  go_to(robot, commands);
  Eigen::MatrixXd slipped_m;
  const Eigen::MatrixXd by_modulus = robot.parameter_sensitivities({{"youngs_modulus_pa", {}}}, slipped_m);
  return robot.body().material().youngs_modulus_pa * by_modulus.block<3, 1>(3 * marker, 0).norm();
}

double distance_m(Simulation& robot, const std::string& marker, const Eigen::Vector3d& target_m, double max_tension_n) {
  robot.reset();
  PolicyTask task{{{{{marker, target_m, 1.0}}}}, {}};
  if (std::isfinite(max_tension_n))
    for (const auto& actuator : robot.actuators())
      task.bounds.push_back({actuator->name(), actuator->limits().min, actuator->limits().max, max_tension_n});
  const PolicyAnswer answer = find_policy(robot, task, {});
  if (!answer.success) throw std::runtime_error("no policy: " + answer.summaries.front().stop_reason);
  return answer.summaries.front().final_distance_m;
}

struct Reach {
  double farthest_m = 0.0, largest_tension_n = 0.0, size = 0.0;
  std::size_t at = 0;
  int without_rest = 0, too_tense = 0;
};

Reach reach_of(const std::vector<WorkspacePoint>& points, const std::vector<bool>& wanted, int marker,
               const Eigen::Vector3d& hanging_m, double max_tension_n) {
  Reach reach;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const WorkspacePoint& point = points[i];
    if (!wanted[i]) continue;
    const bool rests = point.failure.empty(), holds = rests && tension_n(point) <= max_tension_n;
    reach.without_rest += !rests;
    reach.too_tense += rests && !holds;
    if (!holds) continue;
    reach.largest_tension_n = std::max(reach.largest_tension_n, tension_n(point));
    reach.size += size_of(point.jacobian_m) / static_cast<double>(points.size());
    const double far_m = (point.markers_m.col(marker) - hanging_m).norm();
    if (far_m <= reach.farthest_m) continue;
    reach.farthest_m = far_m;
    reach.at = i;
  }
  return reach;
}

}  // namespace

Json assess(const std::string& robot_file, Simulation& robot, const AssessmentSettings& settings) {
  if (!(settings.max_tension_n > 0.0)) throw std::invalid_argument("max_tension_n must be in (0, inf]");
  const WorkspacePlan plan = plan_of(robot_file, robot, settings);
  const int marker = robot.marker_index(plan.marker);
  if (const SolveReport rest = robot.solve_equilibrium(); !rest.converged)
    throw std::runtime_error("the robot does not rest: " + rest.message);
  const Eigen::Vector3d hanging_m = robot.marker_position(marker);
  const std::vector<bool> wanted = wanted_points(plan, robot, settings.one_at_a_time);
  const Reach reach = reach_of(walk(plan, robot, wanted), wanted, marker, hanging_m, settings.max_tension_n);
  const Eigen::VectorXd there = plan.commands.col(static_cast<Eigen::Index>(reach.at));
  double volume = reach.size;
  for (const StudyParameter& command : plan.study.parameters) volume *= command.max - command.min;

  Json result;
  result["reach_m"] = reach.farthest_m;
  for (std::size_t i = 0; i < plan.study.parameters.size(); ++i)
    result["reach_commands"][plan.study.parameters[i].name] = there[static_cast<Eigen::Index>(i)];
  static const char* const names[] = {"workspace_m", "workspace_m2", "workspace_m3"};
  result[names[std::min<std::size_t>(3, plan.study.parameters.size()) - 1]] =
      settings.one_at_a_time ? Json() : Json(volume);
  result["largest_tension_n"] = reach.largest_tension_n;
  result["mass_kg"] = robot.body().node_masses_kg().sum();
  result["stiffness_sensitivity_m"] = stiffness_sensitivity_m(robot, marker, there);
  double sum_m = 0.0;
  for (const Eigen::Vector3d& target_m : settings.targets_m)
    sum_m += distance_m(robot, plan.marker, target_m, settings.max_tension_n);
  const auto count = static_cast<double>(settings.targets_m.size());
  result["mean_distance_m"] = settings.targets_m.empty() ? Json() : Json(sum_m / count);
  result["without_rest"] = reach.without_rest;
  result["too_tense"] = reach.too_tense;
  return result;
}

}  // namespace soft_robot_lab
