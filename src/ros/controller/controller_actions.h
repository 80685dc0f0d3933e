// SPDX-License-Identifier: BSD-3-Clause
// What the controller's services do, as actions (actionlib): with feedback, and to be preempted. And `reach` and
// `follow_path`, which search and move.
#pragma once

#include <functional>
#include <mutex>
#include <string>

#include <Eigen/Core>
#include <actionlib/server/simple_action_server.h>
#include <geometry_msgs/PoseStamped.h>
#include <ros/ros.h>
#include <soft_robot_lab/ActuatorCommand.h>
#include <soft_robot_lab/ExecutePolicy.h>
#include <soft_robot_lab/ExecutePolicyAction.h>
#include <soft_robot_lab/FitModel.h>
#include <soft_robot_lab/FitModelAction.h>
#include <soft_robot_lab/FollowPathAction.h>
#include <soft_robot_lab/OptimisePolicy.h>
#include <soft_robot_lab/OptimisePolicyAction.h>
#include <soft_robot_lab/ReachAction.h>

namespace soft_robot_lab {

// Each answers as its service does, refusals too. Called from threads of the actions.
struct ControllerHandlers {
  std::function<void(const OptimisePolicy::Request&, OptimisePolicy::Response&)> optimise;
  std::function<void(const ExecutePolicy::Request&, ExecutePolicy::Response&)> execute;
  std::function<void(const FitModel::Request&, FitModel::Response&)> fit;
  std::function<FollowPathResult(const FollowPathGoal&, const std::function<void(const FollowPathFeedback&)>&)> follow;
  std::function<Eigen::Vector3d(const geometry_msgs::PoseStamped& pose)> in_robot_base;  // throws where it has no place
  std::function<void()> cancel;  // what is searched for or executed
  std::function<void()> cancel_fit;
};

class ControllerActions {
 public:
  ControllerActions(ros::NodeHandle& node, ControllerHandlers handlers);
  ~ControllerActions();

  void on_fit_progress(int iteration, double rms_gap_m);

 private:
  template <typename Action>
  using Server = actionlib::SimpleActionServer<Action>;

  void optimise(const OptimisePolicyGoalConstPtr& goal);
  void execute(const ExecutePolicyGoalConstPtr& goal);
  void fit(const FitModelGoalConstPtr& goal);
  void follow(const FollowPathGoalConstPtr& goal);
  void reach(const ReachGoalConstPtr& goal);
  ReachResult search_and_move(const ReachGoal& goal);
  OptimisePolicy::Response search(const ReachGoal& goal, const Eigen::Vector3d& target_m);
  void show_stage(const std::string& stage);
  void on_progress(const PolicyProgress& progress);
  void on_command(const ActuatorCommand& command);

  ControllerHandlers handlers_;
  Server<OptimisePolicyAction> optimise_;
  Server<ExecutePolicyAction> execute_;
  Server<FitModelAction> fit_;
  Server<FollowPathAction> follow_;
  Server<ReachAction> reach_;
  std::mutex mutex_;  // guards what follows
  bool optimises_ = false, executes_ = false, fits_ = false, reaches_ = false;
  ReachFeedback reach_feedback_;
  ros::Subscriber progress_, commands_;
};

}  // namespace soft_robot_lab
