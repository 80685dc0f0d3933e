#include "soft_robot_lab/ros/policy_request.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "soft_robot_lab/ros/conversions.h"

namespace soft_robot_lab {
namespace {

void narrow(ReachProblem& problem, int index, const ActuatorLimits& asked) {
  const double min = problem.min[index];
  const double max = problem.max[index];
  if (!(asked.min >= min && asked.min <= asked.max && asked.max <= max)) {
    std::ostringstream message;
    message << "limits: [" << asked.min << ", " << asked.max << "] for '" << asked.name
            << "' is not an interval within [" << min << ", " << max << "]";
    throw std::invalid_argument(message.str());
  }
  problem.min[index] = asked.min;
  problem.max[index] = asked.max;
  problem.start[index] = std::clamp(problem.start[index], asked.min, asked.max);
}

}  // namespace

ReachProblem reach_problem(const OptimisePolicy::Request& request, const Simulation& simulation) {
  simulation.marker_index(request.marker);
  ReachProblem problem;
  problem.target_m = from_message(request.target, "target");
  const auto& actuators = simulation.actuators();
  const int count = static_cast<int>(actuators.size());
  if (count == 0) throw std::invalid_argument("the scene has no actuators to optimise");
  problem.start.resize(count);
  problem.min.resize(count);
  problem.max.resize(count);
  for (int i = 0; i < count; ++i) {
    const CommandLimits& limits = actuators[i]->limits();
    problem.names.push_back(actuators[i]->name());
    problem.start[i] = limits.rest;
    problem.min[i] = limits.min;
    problem.max[i] = limits.max;
  }
  for (const ActuatorLimits& asked : request.limits) narrow(problem, simulation.actuator_index(asked.name), asked);
  return problem;
}

OptimiserOptions optimiser_options(const OptimisePolicy::Request& request) {
  OptimiserOptions options;
  options.method = request.method;
  options.validate();
  return options;
}

double execution_time_limit_s(const ExecutePolicy::Request& request) {
  constexpr double default_settling_s = 30.0;
  const double end_s = request.policy.steps.back().time_s;
  if (request.time_limit_s == 0.0) return end_s + default_settling_s;
  if (!(request.time_limit_s > end_s)) {
    std::ostringstream message;
    message << "time_limit_s: " << request.time_limit_s << " is not 0 nor in (" << end_s << ", inf), the policy's end";
    throw std::invalid_argument(message.str());
  }
  return request.time_limit_s;
}

Policy policy_of(const std::vector<std::string>& names, const Eigen::VectorXd& commands, double ramp_s) {
  Policy policy;
  policy.names = names;
  policy.steps.resize(1);
  policy.steps[0].time_s = ramp_s;
  policy.steps[0].values.assign(commands.data(), commands.data() + commands.size());
  return policy;
}

PolicySummary to_message(const OptimisationSummary& summary) {
  PolicySummary message;
  message.usable = summary.usable;
  message.target_reached = summary.target_reached;
  message.stop_reason = summary.stop_reason;
  message.initial_distance_m = summary.initial_distance_m;
  message.final_distance_m = summary.final_distance_m;
  message.marker = to_message(summary.marker_m);
  message.iterations = summary.iterations;
  message.evaluations = summary.evaluations;
  message.cpu_s = summary.cpu_s;
  message.wall_s = summary.wall_s;
  message.active_limits = summary.active_limits;
  return message;
}

}  // namespace soft_robot_lab
