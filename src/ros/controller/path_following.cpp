// SPDX-License-Identifier: BSD-3-Clause
#include "path_following.h"

#include <algorithm>
#include <limits>
#include <sstream>
#include <stdexcept>

#include <ros/console.h>

#include "interruptible.h"
#include "policy_request.h"
#include "ros/base/behind_others.h"
#include "ros/base/log_text.h"
#include "ros/base/topics.h"
#include "ros/messages/message_limits.h"
#include "settings/require_in_range.h"
#include "soft_robot_lab/control/forward_model.h"

namespace soft_robot_lab {
namespace {

constexpr int kModelRounds = 3;     // of corrections on the model's own motion in time
constexpr double kSettling_s = 30;  // at the path's start
constexpr double kRigLag_s = 0.05;  // from a command to the marker, of the emulated rig
constexpr double kPatience = 2.0;   // durations, for what waits for a marker

PathTask task_of(const FollowPathGoal& goal) {
  require_in_limits<FollowPathGoal>(goal);
  require_whole_path("path", goal.path);
  require_in_range("rounds", goal.rounds, {0.0, 20.0});
  require_in_range("duration_s", goal.duration_s, {0.0, limits::kTime_s});
  if (goal.rounds > 0 && !goal.feedback) throw std::invalid_argument("rounds: learning needs feedback: true");
  PathTask task = load_path_task(goal.path);
  if (goal.duration_s > 0.0) task.duration_s = goal.duration_s;
  if (goal.fastest) task.duration_s = 0.0;
  for (const ActuatorLimits& limits : goal.limits) task.bounds.push_back(bounds_of(limits));
  return task;
}

void require_in_reach(const PathPlan& plan, double tolerance_m) {
  if (plan.largest_unreachable_m() <= tolerance_m) return;
  const auto worst = std::max_element(
      plan.samples.begin(), plan.samples.end(),
      [](const PathSample& one, const PathSample& other) { return one.unreachable_m < other.unreachable_m; });
  std::ostringstream text;
  text.precision(3);
  text << "curve: out of reach by " << 1e3 * worst->unreachable_m << " mm at " << 1e3 * worst->way_m
       << " mm along it, tolerance_m is " << 1e3 * tolerance_m << " mm; nearest: true goes as near as it can";
  throw std::invalid_argument(text.str());
}

FollowOptions follow_options(bool feedback, double lag_s) {
  FollowOptions options;
  options.feedback = feedback;
  options.gain = 0.1;  // as `experiment paths`: noise of markers is not followed
  options.drive_lag_s = lag_s;
  options.lead_s = options.drive_lag_s + 0.5 * kFollowPeriod_s;  // a command stands for a period
  return options;
}

// Less than on the model: what is measured has noise.
LearnOptions learn_options() {
  LearnOptions options;
  options.gain = 0.4;
  options.smoothing = 8;
  return options;
}

FollowPathFeedback stage(const std::string& name, int round) {
  FollowPathFeedback feedback;
  feedback.stage = name;
  feedback.round = round;
  feedback.distance_m = -1.0;
  return feedback;
}

}  // namespace

FollowPathResult PathFollowing::follow(const FollowPathGoal& goal, const Feedback& feedback) {
  FollowPathResult result;
  try {
    if (execution_.running()) throw std::runtime_error("busy with another policy; ask again when it ended");
    const auto preparation = execution_.prepare();
    feedback(stage("plans", 0));
    Planned planned = behind_others([&] { return plan(goal, result); });
    result.policy = to_message(policy_of(planned.path));
    result.policy.robot = planned.robot;
    if (!goal.plan_only) play(goal, planned, feedback, result);
    result.success = true;
  } catch (const std::exception& error) {
    result.message = execution_.cancelled() ? "cancelled" : answer_text(error);
  }
  if (!result.success) ROS_WARN("%s refused: %s", topics::follow_path, log_text(result.message).c_str());
  return result;
}

PathFollowing::Planned PathFollowing::plan(const FollowPathGoal& goal, FollowPathResult& result) {
  const PathTask task = task_of(goal);
  const auto no_answers = live_.pause();
  const auto lock = model_.lock_or_refuse();
  Simulation& simulation = model_.to_search();
  const Interruptible interruptible(simulation, [this] { return execution_.cancelled() || !ros::ok(); });
  simulation.reset();
  simulation.solve_equilibrium();
  Planned planned{plan_motion(simulation, task), robot_().name};
  PathPlan& path = planned.path;
  if (!path.complete) throw std::runtime_error(path.message);
  result.out_of_reach_m = path.largest_unreachable_m();
  shown_(path, task.tolerance_m);
  if (!goal.nearest) require_in_reach(path, task.tolerance_m);
  finish_in_time(simulation, path, kModelRounds, {});
  shown_(path, task.tolerance_m);
  planned.step_s = simulation.options().time_step_s;
  planned.marker = static_cast<std::size_t>(simulation.marker_index(path.marker));
  result.duration_s = path.duration_s();
  result.fastest_s = path.fastest_s;
  result.predicted_rms_m = path.predicted_rms_m();
  return planned;
}

void PathFollowing::play(const FollowPathGoal& goal, Planned& planned, const Feedback& feedback,
                         FollowPathResult& result) {
  double best_m = std::numeric_limits<double>::infinity();
  for (int round = 0; round <= goal.rounds; ++round) {
    if (execution_.cancelled()) throw ForwardModelInterrupted();
    feedback(stage("approaches", round));
    const auto on_path = [&](double path_s, std::optional<double> distance_m) {
      FollowPathFeedback now = stage("follows", round);
      now.path_s = path_s;
      now.distance_m = distance_m.value_or(-1.0);
      feedback(now);
    };
    const ExecutionReport report = play_once(planned, goal.feedback, on_path);
    result.measured_rms_m.push_back(report.measured_path_rms_m.value_or(-1.0));
    result.simulated_rms_m.push_back(report.simulated_path_rms_m.value_or(-1.0));
    if (!report.success) throw std::runtime_error(report.message);
    if (goal.rounds == 0) return;
    if (report.measured_path.time_s.empty())
      throw std::runtime_error("rounds: marker '" + planned.path.marker + "' was never seen, so nothing can be learnt");
    if (const double measured_m = result.measured_rms_m.back(); measured_m < best_m) {
      best_m = measured_m;
      result.policy.steps = to_message(policy_of(planned.path)).steps;
    }
    learn(planned.path, report.measured_path, learn_options());
  }
}

// From where the actuators stand to the path's start, to rest there, and along it.
ExecutionReport PathFollowing::play_once(const Planned& planned, bool with_feedback,
                                         const decltype(ExecutionOrder::on_path)& on_path) {
  const Robot robot = robot_();
  if (robot.name != planned.robot) throw std::runtime_error("another robot runs now than the path was planned for");
  const double lag_s = execution_.has_motors() ? kRigLag_s : planned.step_s;
  PathFollower follower(planned.path, follow_options(with_feedback, lag_s));
  ExecutionOrder order;
  for (const PathDrive& drive : planned.path.drives) {
    order.policy.names.push_back(drive.actuator);
    order.start_values.push_back(robot.commands.at(drive.actuator));
  }
  const Eigen::VectorXd& start = planned.path.samples.front().commands;
  order.policy.steps = {{ramp_s_, {start.data(), start.data() + start.size()}}};
  order.time_limit_s = ramp_s_ + kSettling_s + kPatience * planned.path.duration_s();
  order.follower = &follower;
  order.followed_marker = planned.marker;
  order.on_path = on_path;
  return execution_.follow(order);
}

}  // namespace soft_robot_lab
