#include "soft_robot_lab/control/find_policy.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace soft_robot_lab {
namespace {

template <typename... Parts>
[[noreturn]] void refuse(const Parts&... parts) {
  std::ostringstream message;
  (message << ... << parts);
  throw std::invalid_argument(message.str());
}

std::vector<std::string> movable(const Simulation& simulation, const Pose& pose) {
  if (!pose.actuators.empty()) return pose.actuators;
  std::vector<std::string> all;
  for (const auto& actuator : simulation.actuators()) all.push_back(actuator->name());
  return all;
}

void require_bounds(const Simulation& simulation, const ActuatorBounds& asked) {
  const CommandLimits& own = simulation.actuators()[static_cast<size_t>(simulation.actuator_index(asked.actuator))]->limits();
  if (!(asked.min >= own.min && asked.min < asked.max && asked.max <= own.max)) {
    refuse("limits: [", asked.min, ", ", asked.max, "] for '", asked.actuator, "' is not an interval within [", own.min,
           ", ", own.max, "]");
  }
  if (!(asked.max_tension_n > 0.0))
    refuse("limits: max_tension_n ", asked.max_tension_n, " for '", asked.actuator, "' is not in (0, inf]");
  if (!(asked.max_rate_per_s > 0.0))
    refuse("limits: max_rate_per_s ", asked.max_rate_per_s, " for '", asked.actuator, "' is not in (0, inf]");
}

void require_task(const Simulation& simulation, const PolicyTask& task) {
  if (simulation.actuators().empty()) refuse("the scene has no actuators to optimise");
  if (task.poses.empty()) refuse("poses: empty; give at least one");
  for (const Pose& pose : task.poses) {
    if (pose.goals.empty()) refuse("goals: empty; give at least one");
    for (const MarkerGoal& goal : pose.goals) {
      simulation.marker_index(goal.marker);
      if (!goal.target_m.allFinite()) refuse("target of ", goal.marker, ": [", goal.target_m.transpose(), "] must be finite");
      if (!(goal.weight > 0.0 && std::isfinite(goal.weight)))
        refuse("weight of ", goal.marker, ": ", goal.weight, " is not in (0, inf)");
    }
    for (const std::string& name : pose.actuators) simulation.actuator_index(name);
    if (!(pose.duration_s > 0.0 && std::isfinite(pose.duration_s)))
      refuse("duration_s: ", pose.duration_s, " is not in (0, inf)");
  }
  for (const ActuatorBounds& asked : task.bounds) require_bounds(simulation, asked);
  if (!(task.effort_m >= 0.0 && std::isfinite(task.effort_m))) refuse("effort_m: ", task.effort_m, " is not in [0, inf)");
}

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
  if (slower) problem.bound_words[static_cast<size_t>(i)] = "rate " + std::to_string(asked.max_rate_per_s) + " a second";
}

// The problem of one pose without its model, from the present commands.
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
    const Actuator& actuator = *simulation.actuators()[static_cast<size_t>(simulation.actuator_index(name))];
    const CommandLimits& own = actuator.limits();
    problem.rest[i] = own.rest;
    problem.min[i] = own.min;
    problem.max[i] = own.max;
    problem.start[i] = actuator.command();
    for (const ActuatorBounds& asked : task.bounds)
      if (asked.actuator == name) narrow(problem, i, asked, pose.duration_s, actuator.command());
  }
  if ((problem.max_tension_n.array() == std::numeric_limits<double>::infinity()).all()) problem.max_tension_n.resize(0);
  return problem;
}

std::vector<std::string> markers_of(const Pose& pose) {
  std::vector<std::string> markers;
  for (const MarkerGoal& goal : pose.goals) markers.push_back(goal.marker);
  return markers;
}

// Leaves the simulation at the answer, on the way on which the policy is played.
void go_to_answer(Simulation& simulation, const SimulationState& before, const Pose& pose,
                  const std::vector<std::string>& names, OptimisationSummary& summary) {
  simulation.set_state(before);
  const Eigen::Matrix3Xd found_m = summary.markers_m;
  const std::vector<double> values(summary.commands.data(), summary.commands.data() + summary.commands.size());
  summary.markers_m = replay(simulation, {names, {{pose.duration_s, values}}}, markers_of(pose)).front();
  const double apart_m = (summary.markers_m - found_m).colwise().norm().maxCoeff();
  constexpr double same_m = 1.0e-4;
  if (apart_m <= same_m) return;
  summary.usable = false;
  std::ostringstream text;
  text << summary.stop_reason << ", but played from the start it ends " << 1.0e3 * apart_m
       << " mm elsewhere: the body has more than one rest state there";
  summary.stop_reason = text.str();
}

OptimisationSummary find_step(Simulation& simulation, const PolicyTask& task, size_t index,
                              const OptimiserOptions& options, const PoseProgress& progress, bool& cancelled) {
  const Pose& pose = task.poses[index];
  const SimulationState before = simulation.state();
  ReachProblem problem = pose_problem(simulation, task, pose);
  ForwardModel model(simulation, markers_of(pose), problem.names);
  problem.model = [&](const Eigen::VectorXd& commands, bool with_derivatives) {
    return model.predict(commands, with_derivatives);
  };
  OptimisationSummary summary = optimise(problem, options, [&](const OptimisationProgress& now) {
    cancelled = progress && !progress(index, problem.names, now);
    return !cancelled;
  });
  if (!summary.usable) return summary;
  try {
    go_to_answer(simulation, before, pose, problem.names, summary);
  } catch (const ForwardModelError& error) {
    summary.usable = false;
    summary.stop_reason += std::string(", but it cannot be played from the start: ") + error.what();
  }
  return summary;
}

// All actuators, at each step as commanded then.
void add_step(const Simulation& simulation, double time_s, CommandPolicy& policy) {
  std::vector<double> values;
  policy.names.clear();
  for (const auto& actuator : simulation.actuators()) {
    policy.names.push_back(actuator->name());
    values.push_back(actuator->command());
  }
  policy.steps.push_back({time_s, values});
}

}  // namespace

PolicyAnswer find_policy(Simulation& simulation, const PolicyTask& task, const OptimiserOptions& options,
                         const PoseProgress& progress) {
  options.validate();
  require_task(simulation, task);
  pose_problem(simulation, task, task.poses.front());  // refuses what the bounds make impossible
  simulation.solve_equilibrium();  // a failure is found again, and told, by the first evaluation
  PolicyAnswer answer;
  double time_s = 0.0;
  bool cancelled = false;
  for (size_t i = 0; i < task.poses.size() && !cancelled; ++i) {
    answer.summaries.push_back(find_step(simulation, task, i, options, progress, cancelled));
    if (!answer.summaries.back().usable) break;
    time_s += task.poses[i].duration_s;
    add_step(simulation, time_s, answer.policy);
  }
  answer.success = answer.policy.steps.size() == task.poses.size();
  return answer;
}

}  // namespace soft_robot_lab
