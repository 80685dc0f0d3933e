// SPDX-License-Identifier: BSD-3-Clause
#include "pose_problem.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "mechanics/simulation/limit_hint.h"
#include "refuse.h"
#include "search.h"
#include "settings/limits.h"

namespace soft_robot_lab {
namespace {

std::vector<std::string> movable(const Simulation& simulation, const Pose& pose) {
  if (!pose.actuators.empty()) return pose.actuators;
  std::vector<std::string> all;
  for (const auto& actuator : simulation.actuators()) all.push_back(actuator->name());
  return all;
}

void require_goal(const Simulation& simulation, const MarkerGoal& goal) {
  simulation.marker_index(goal.marker);
  if (!(goal.target_m.cwiseAbs().maxCoeff() <= limits::kPlace_m) || !goal.target_m.allFinite())
    refuse("target of ", goal.marker, ": [", goal.target_m.transpose(), "] is not within ", limits::kPlace_m,
           " m; it is in metres");
  if (!(goal.weight > 0.0 && goal.weight <= limits::kWeight))
    refuse("weight of ", goal.marker, ": ", goal.weight, " is not in (0, ", limits::kWeight, "]");
}

void require_bounds(const Simulation& simulation, const ActuatorBounds& asked) {
  const int index = simulation.actuator_index(asked.actuator);
  const CommandLimits& own = simulation.actuators()[static_cast<size_t>(index)]->limits();
  if (!(asked.min >= own.min && asked.min < asked.max && asked.max <= own.max)) {
    refuse("limits: [", asked.min, ", ", asked.max, "] for '", asked.actuator, "' is not an interval within [", own.min,
           ", ", own.max, "]",
           asked.min < own.min   ? limit_hint(simulation, index, true)
           : asked.max > own.max ? limit_hint(simulation, index, false)
                                 : "");
  }
  if (!(asked.max_tension_n > 0.0))
    refuse("limits: max_tension_n ", asked.max_tension_n, " for '", asked.actuator, "' is not in (0, inf]");
  if (!(asked.max_rate_per_s > 0.0))
    refuse("limits: max_rate_per_s ", asked.max_rate_per_s, " for '", asked.actuator, "' is not in (0, inf]");
}

// No robot reaches further from where its marker hangs than it is large, give or take its stalk and its stretch.
constexpr double kFarthest = 3.0;  // times the body's size

}  // namespace

std::vector<std::string> far_targets(const Simulation& simulation, const PolicyTask& task) {
  std::vector<std::string> warnings;
  const double size_m = simulation.body().size_m();
  for (const Pose& pose : task.poses)
    for (const MarkerGoal& goal : pose.goals) {
      const auto index = static_cast<std::size_t>(simulation.marker_index(goal.marker));
      const double away_m = (goal.target_m - simulation.markers()[index].rest_position_m()).norm();
      if (!(away_m > kFarthest * size_m)) continue;
      std::ostringstream text;
      text.precision(4);
      text << "the target of " << goal.marker << " is " << 1e3 * away_m << " mm away from it, where the robot is "
           << 1e3 * size_m << " mm large";
      warnings.push_back(text.str());
    }
  return warnings;
}

void require_task(const Simulation& simulation, const PolicyTask& task) {
  if (simulation.actuators().empty()) refuse("the scene has no actuators to optimise");
  if (task.poses.empty()) refuse("poses: empty; give at least one");
  for (const Pose& pose : task.poses) {
    if (pose.goals.empty()) refuse("goals: empty; give at least one");
    std::set<std::string> markers, actuators;
    for (const MarkerGoal& goal : pose.goals) {
      require_goal(simulation, goal);
      if (!markers.insert(goal.marker).second) refuse("goals: '", goal.marker, "' is named twice");
    }
    for (const std::string& name : pose.actuators) {
      simulation.actuator_index(name);
      if (!actuators.insert(name).second) refuse("actuators: '", name, "' is named twice");
    }
    if (!(pose.duration_s > 0.0 && pose.duration_s <= limits::kTime_s))
      refuse("duration_s: ", pose.duration_s, " is not in (0, ", limits::kTime_s, "]");
  }
  std::set<std::string> bounded;
  for (const ActuatorBounds& asked : task.bounds) {
    require_bounds(simulation, asked);
    if (!bounded.insert(asked.actuator).second) refuse("limits: '", asked.actuator, "' is named twice");
  }
  if (!(task.effort_m >= 0.0 && task.effort_m <= limits::kPlace_m))
    refuse("effort_m: ", task.effort_m, " is not in [0, ", limits::kPlace_m, "]");
}

namespace {

void narrow(ReachProblem& problem, Eigen::Index i, const ActuatorBounds& asked, double duration_s, double before) {
  problem.min[i] = asked.min;
  problem.max[i] = asked.max;
  problem.max_tension_n[i] = asked.max_tension_n;
  problem.start[i] = std::clamp(problem.start[i], asked.min, asked.max);
  if (!std::isfinite(asked.max_rate_per_s)) return;
  const double reach = asked.max_rate_per_s * duration_s;
  if (before + reach < problem.min[i] || before - reach > problem.max[i])
    refuse("limits: '", asked.actuator, "' at ", before, " cannot come within [", asked.min, ", ", asked.max, "] in ",
           duration_s, " s at ", asked.max_rate_per_s, " a second");
  const bool slower = before - reach > problem.min[i] || before + reach < problem.max[i];
  problem.min[i] = std::max(problem.min[i], before - reach);
  problem.max[i] = std::min(problem.max[i], before + reach);
  problem.start[i] = std::clamp(problem.start[i], problem.min[i], problem.max[i]);
  if (slower)
    problem.bound_words[static_cast<size_t>(i)] = "rate " + std::to_string(asked.max_rate_per_s) + " a second";
}

}  // namespace

ReachProblem pose_problem(const Simulation& simulation, const PolicyTask& task, const Pose& pose) {
  ReachProblem problem;
  for (const MarkerGoal& goal : pose.goals) problem.goals.push_back({goal.target_m, goal.weight});
  problem.names = movable(simulation, pose);
  problem.effort_m = task.effort_m;
  const Eigen::Index count = static_cast<Eigen::Index>(problem.names.size());
  for (Eigen::VectorXd* values : {&problem.start, &problem.min, &problem.max, &problem.rest}) values->resize(count);
  problem.max_tension_n = Eigen::VectorXd::Constant(count, std::numeric_limits<double>::infinity());
  problem.bound_words.resize(problem.names.size());
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::string& name = problem.names[static_cast<size_t>(i)];
    const auto index = static_cast<size_t>(simulation.actuator_index(name));
    const double command = simulation.state().drives[index].command;
    const CommandLimits& own = simulation.actuators()[index]->limits();
    problem.rest[i] = own.rest;
    problem.min[i] = own.min;
    problem.max[i] = own.max;
    problem.start[i] = command;
    for (const ActuatorBounds& asked : task.bounds)
      if (asked.actuator == name) narrow(problem, i, asked, pose.duration_s, command);
  }
  if ((problem.max_tension_n.array() == std::numeric_limits<double>::infinity()).all()) problem.max_tension_n.resize(0);
  return problem;
}

void command_only(Simulation& simulation, const SimulationState& before, const std::vector<std::string>& names,
                  OptimisationSummary& summary) {
  simulation.set_state(before);
  for (std::size_t i = 0; i < names.size(); ++i)
    simulation.set_command(names[i], summary.commands[static_cast<Eigen::Index>(i)]);
  summary.stop_reason = kCancelled;
}

std::vector<std::string> markers_of(const Pose& pose) {
  std::vector<std::string> markers;
  for (const MarkerGoal& goal : pose.goals) markers.push_back(goal.marker);
  return markers;
}

}  // namespace soft_robot_lab
