// SPDX-License-Identifier: BSD-3-Clause
#include "policy_request.h"

#include <iomanip>
#include <sstream>
#include <stdexcept>

#include "ros/messages/conversions.h"
#include "ros/messages/message_limits.h"
#include "settings/limits.h"

namespace soft_robot_lab {
namespace {

Pose pose_of(const PolicyPose& asked, double ramp_s) {
  if (asked.targets.size() != asked.markers.size())
    throw std::invalid_argument("poses.targets: " + std::to_string(asked.targets.size()) + " targets for " +
                                std::to_string(asked.markers.size()) + " markers");
  if (!asked.weights.empty() && asked.weights.size() != asked.markers.size())
    throw std::invalid_argument("poses.weights: " + std::to_string(asked.weights.size()) + " weights for " +
                                std::to_string(asked.markers.size()) + " markers");
  Pose pose;
  for (size_t i = 0; i < asked.markers.size(); ++i)
    pose.goals.push_back({asked.markers[i], from_message(asked.targets[i], "poses.targets"),
                          asked.weights.empty() ? 1.0 : asked.weights[i]});
  pose.duration_s = asked.duration_s == 0.0 ? ramp_s : asked.duration_s;
  pose.actuators = asked.actuators;
  return pose;
}

std::string mm_text(const Eigen::Vector3d& at_m) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(2) << "[" << 1e3 * at_m.x() << ", " << 1e3 * at_m.y() << ", "
       << 1e3 * at_m.z() << "] mm";
  return text.str();
}

std::string outcome(const OptimisationSummary& summary, const Pose& pose) {
  if (!summary.usable || summary.target_reached || summary.stop_reason != "converged") return summary.stop_reason;
  std::ostringstream text;
  text.precision(4);
  text << summary.stop_reason << "; out of reach by " << 1e3 * summary.final_distance_m << " mm, nearest:";
  for (Eigen::Index k = 0; k < summary.markers_m.cols(); ++k)
    text << " " << pose.goals[static_cast<size_t>(k)].marker << " at " << mm_text(summary.markers_m.col(k));
  for (const std::string& limit : summary.active_limits) text << "; " << limit;
  return text.str();
}

}  // namespace

ActuatorBounds bounds_of(const ActuatorLimits& asked) {
  ActuatorBounds bounds;
  bounds.actuator = asked.name;
  bounds.min = asked.min;
  bounds.max = asked.max;
  if (asked.max_tension_n != 0.0) bounds.max_tension_n = asked.max_tension_n;
  if (asked.max_rate_per_s != 0.0) bounds.max_rate_per_s = asked.max_rate_per_s;
  return bounds;
}

PolicyTask policy_task(const OptimisePolicy::Request& request, double ramp_s) {
  PolicyTask task;
  for (const PolicyPose& pose : request.poses) task.poses.push_back(pose_of(pose, ramp_s));
  if (task.poses.empty()) {
    task.poses.push_back({{{request.marker, from_message(request.target, "target"), 1.0}}, ramp_s, {}});
  } else if (!request.marker.empty()) {
    throw std::invalid_argument("marker: '" + request.marker + "' beside poses; give one or the other");
  }
  for (const ActuatorLimits& limits : request.limits) task.bounds.push_back(bounds_of(limits));
  task.effort_m = request.effort_m;
  require_in_limits<OptimisePolicy::Request>(request);
  return task;
}

PolicyTask correction_task(const ExecutePolicy::Request& request, const std::optional<PolicyTask>& found) {
  if (!request.goal.markers.empty()) {
    PolicyTask task;
    task.poses.push_back(pose_of(request.goal, Pose().duration_s));
    for (const ActuatorLimits& limits : request.limits) task.bounds.push_back(bounds_of(limits));
    return task;
  }
  if (!request.limits.empty()) throw std::invalid_argument("limits: given without a goal");
  if (!found) throw std::invalid_argument("goal.markers: none, and no policy was found yet whose goal could be taken");
  PolicyTask task = *found;
  task.poses = {found->poses.back()};
  return task;
}

void count_as_reached(const OptimisePolicy::Request& request, PolicyAnswer& answer) {
  if (request.tolerance_m == 0.0) count_as_reached(answer);
}

void fill_response(const PolicyAnswer& answer, const PolicyTask& task, OptimisePolicy::Response& response) {
  for (const OptimisationSummary& summary : answer.summaries) response.poses.push_back(to_message(summary));
  response.summary = response.poses.back();
  response.success = answer.success;
  response.message = outcome(answer.summaries.back(), task.poses[answer.summaries.size() - 1]);
  if (answer.success) response.policy = to_message(answer.policy);
}

OptimiserOptions optimiser_options(const OptimisePolicy::Request& request) {
  OptimiserOptions options;
  options.method = request.method;
  options.max_iterations = request.max_iterations;
  if (request.tolerance_m != 0.0) options.tolerance_m = request.tolerance_m;
  if (request.seed != 0) options.seed = request.seed;
  options.validate();
  return options;
}

double execution_time_limit_s(const ExecutePolicy::Request& request) {
  require_in_limits<ExecutePolicy::Request>(request);
  const double default_settling_s = request.closed_loop ? 180.0 : 30.0;
  const double end_s = request.policy.steps.back().time_s;
  if (request.time_limit_s == 0.0) return end_s + default_settling_s;
  if (!(request.time_limit_s > end_s && request.time_limit_s <= limits::kTime_s)) {
    std::ostringstream message;
    message << "time_limit_s: " << request.time_limit_s << " is not 0 nor in (" << end_s << ", " << limits::kTime_s
            << "], from the policy's end";
    throw std::invalid_argument(message.str());
  }
  return request.time_limit_s;
}

CommandPolicy from_message(const Policy& message) {
  CommandPolicy policy;
  policy.names = message.names;
  policy.robot = message.robot;
  for (const PolicyStep& step : message.steps) policy.steps.push_back({step.time_s, step.values});
  return policy;
}

Policy to_message(const CommandPolicy& policy) {
  Policy message;
  message.names = policy.names;
  message.robot = policy.robot;
  for (const TimedCommandValues& step : policy.steps) {
    message.steps.emplace_back();
    message.steps.back().time_s = step.time_s;
    message.steps.back().values = step.values;
  }
  return message;
}

PolicySummary to_message(const OptimisationSummary& summary) {
  PolicySummary message;
  message.usable = summary.usable;
  message.target_reached = summary.target_reached;
  message.stop_reason = summary.stop_reason;
  message.initial_distance_m = summary.initial_distance_m;
  message.final_distance_m = summary.final_distance_m;
  if (summary.markers_m.cols() > 0) message.marker = to_message(Eigen::Vector3d(summary.markers_m.col(0)));
  message.iterations = summary.iterations;
  message.evaluations = summary.evaluations;
  message.cpu_s = summary.cpu_s;
  message.wall_s = summary.wall_s;
  message.active_limits = summary.active_limits;
  return message;
}

}  // namespace soft_robot_lab
