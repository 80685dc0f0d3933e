// SPDX-License-Identifier: BSD-3-Clause
#include "controller_actions.h"

#include <algorithm>
#include <exception>
#include <stdexcept>
#include <utility>

#include "ros/messages/conversions.h"
#include "ros/messages/message_limits.h"
#include "ros/messages/same_fields.h"
#include "ros/base/log_text.h"
#include "ros/base/topics.h"

namespace soft_robot_lab {
namespace {

// An action that did not succeed is aborted, or preempted where that was asked for.
template <typename Server, typename Result>
void finish(Server& server, const Result& result) {
  if (server.isPreemptRequested())
    server.setPreempted(result, result.message);
  else if (result.success)
    server.setSucceeded(result, result.message);
  else
    server.setAborted(result, result.message);
}

// Feedback goes only to a goal whose work runs.
class Running {
 public:
  Running(std::mutex& mutex, bool& flag) : mutex_(mutex), flag_(flag) { set(true); }
  ~Running() { set(false); }

 private:
  void set(bool runs) {
    const std::lock_guard lock(mutex_);
    flag_ = runs;
  }
  std::mutex& mutex_;
  bool& flag_;
};

// Ends a goal with what the handler of the service of the same fields answers; `flag` is set meanwhile.
template <typename Service, typename Result, typename Server, typename Goal, typename Handler>
void answer(Server& server, const Goal& goal, const Handler& handler, std::mutex& mutex, bool& flag) {
  const auto request = same_fields<typename Service::Request>(goal);
  typename Service::Response response;
  {
    const Running running(mutex, flag);
    handler(request, response);
  }
  finish(server, same_fields<Result>(response));
}

// Where the marker rests: as an execution found it.
double final_distance_m(const ExecutePolicy::Response& moved, const std::string& marker,
                        const Eigen::Vector3d& target_m, bool closed_loop) {
  if (closed_loop) return moved.final_distance_m;
  const auto& names = moved.markers.names;
  if (std::find(names.begin(), names.end(), marker) == names.end()) return -1.0;
  return (position_of(moved.markers, marker) - target_m).norm();
}

}  // namespace

ControllerActions::ControllerActions(ros::NodeHandle& node, ControllerHandlers handlers)
    : handlers_(std::move(handlers)),
      optimise_(
          node, topics::optimise_policy, [this](const auto& goal) { optimise(goal); }, false),
      execute_(
          node, topics::execute_policy, [this](const auto& goal) { execute(goal); }, false),
      fit_(
          node, topics::fit_model, [this](const auto& goal) { fit(goal); }, false),
      follow_(
          node, topics::follow_path, [this](const auto& goal) { follow(goal); }, false),
      reach_(
          node, topics::reach, [this](const auto& goal) { reach(goal); }, false) {
  optimise_.registerPreemptCallback([this] { handlers_.cancel(); });
  execute_.registerPreemptCallback([this] { handlers_.cancel(); });
  reach_.registerPreemptCallback([this] { handlers_.cancel(); });
  follow_.registerPreemptCallback([this] { handlers_.cancel(); });
  fit_.registerPreemptCallback([this] { handlers_.cancel_fit(); });
  progress_ = node.subscribe(topics::controller_progress, 100, &ControllerActions::on_progress, this);
  commands_ = node.subscribe(topics::actuator_command, 100, &ControllerActions::on_command, this);
  optimise_.start();
  execute_.start();
  fit_.start();
  follow_.start();
  reach_.start();
}

// Their threads end with what they do.
ControllerActions::~ControllerActions() {
  handlers_.cancel();
  handlers_.cancel_fit();
}

void ControllerActions::optimise(const OptimisePolicyGoalConstPtr& goal) {
  answer<OptimisePolicy, OptimisePolicyResult>(optimise_, *goal, handlers_.optimise, mutex_, optimises_);
}

void ControllerActions::execute(const ExecutePolicyGoalConstPtr& goal) {
  answer<ExecutePolicy, ExecutePolicyResult>(execute_, *goal, handlers_.execute, mutex_, executes_);
}

void ControllerActions::fit(const FitModelGoalConstPtr& goal) {
  answer<FitModel, FitModelResult>(fit_, *goal, handlers_.fit, mutex_, fits_);
}

void ControllerActions::follow(const FollowPathGoalConstPtr& goal) {
  finish(follow_, handlers_.follow(*goal, [this](const auto& feedback) { follow_.publishFeedback(feedback); }));
}

void ControllerActions::reach(const ReachGoalConstPtr& goal) {
  ReachResult result;
  result.final_distance_m = -1.0;
  try {
    const Running running(mutex_, reaches_);
    result = search_and_move(*goal);
  } catch (const std::exception& error) {
    result.message = answer_text(error);
  }
  finish(reach_, result);
}

ReachResult ControllerActions::search_and_move(const ReachGoal& goal) {
  ReachResult result;
  result.final_distance_m = -1.0;
  require_in_limits<ReachGoal>(goal);
  const Eigen::Vector3d target_m = handlers_.in_robot_base(goal.target);
  show_stage("searches");
  const OptimisePolicy::Response found = search(goal, target_m);
  result.message = found.message;
  result.policy = found.policy;
  result.summary = found.summary;
  if (!found.success || reach_.isPreemptRequested()) return result;
  show_stage("moves");
  ExecutePolicy::Request request;
  request.policy = found.policy;
  request.wait_until_rest = true;
  request.closed_loop = goal.closed_loop;
  ExecutePolicy::Response moved;
  handlers_.execute(request, moved);
  result.success = moved.success;
  if (!moved.message.empty()) result.message = moved.message;
  result.final_distance_m = final_distance_m(moved, goal.marker, target_m, goal.closed_loop);
  return result;
}

OptimisePolicy::Response ControllerActions::search(const ReachGoal& goal, const Eigen::Vector3d& target_m) {
  OptimisePolicy::Request request;
  request.method = goal.method.empty() ? "gauss_newton" : goal.method;
  request.marker = goal.marker;
  request.target = to_message(target_m);
  request.tolerance_m = goal.tolerance_m;
  OptimisePolicy::Response response;
  handlers_.optimise(request, response);
  return response;
}

void ControllerActions::show_stage(const std::string& stage) {
  const std::lock_guard lock(mutex_);
  reach_feedback_ = {};
  reach_feedback_.stage = stage;
  reach_.publishFeedback(reach_feedback_);
}

void ControllerActions::on_progress(const PolicyProgress& progress) {
  if (!is_in_limits<PolicyProgress>(progress)) return;
  const std::lock_guard lock(mutex_);
  if (optimises_) {
    OptimisePolicyFeedback feedback;
    feedback.progress = progress;
    optimise_.publishFeedback(feedback);
  }
  if (!reaches_) return;
  reach_feedback_.progress = progress;
  reach_.publishFeedback(reach_feedback_);
}

void ControllerActions::on_command(const ActuatorCommand& command) {
  const std::lock_guard lock(mutex_);
  if (!executes_) return;
  ExecutePolicyFeedback feedback;
  feedback.command = command;
  execute_.publishFeedback(feedback);
}

void ControllerActions::on_fit_progress(int iteration, double rms_gap_m) {
  const std::lock_guard lock(mutex_);
  if (!fits_) return;
  FitModelFeedback feedback;
  feedback.iteration = iteration;
  feedback.rms_gap_m = rms_gap_m;
  fit_.publishFeedback(feedback);
}

}  // namespace soft_robot_lab
