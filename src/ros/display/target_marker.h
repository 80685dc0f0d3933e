// SPDX-License-Identifier: BSD-3-Clause
// The target as a thing to drag in rviz (an interactive marker), and as a pose that rviz's tools or programs send.
#pragma once

#include <functional>
#include <mutex>
#include <string>

#include <Eigen/Core>
#include <geometry_msgs/PoseStamped.h>
#include <interactive_markers/interactive_marker_server.h>
#include <ros/ros.h>
#include <tf2_ros/buffer.h>

#include "ros/base/frame_listener.h"
#include "session/held_target.h"

namespace soft_robot_lab {

class TargetMarker {
 public:
  // `released`: it is held no longer, so this is where it shall be.
  using Moved = std::function<void(const std::string& marker, const Eigen::Vector3d& target_m, bool released)>;

  // Called from whatever threads serve the node's topics.
  TargetMarker(ros::NodeHandle& node, Moved moved);

  // Where that is [m, robot_base]: frames of a session do not move, so its time does not count. Throws tf2's
  // exceptions, and std::invalid_argument for a place that is not finite.
  Eigen::Vector3d in_robot_base(const geometry_msgs::PoseStamped& pose) const;

  // Of that marker, there [m, robot_base]; `size_m` is that of its arrows. A hand that holds it keeps it.
  void show(const std::string& marker, const Eigen::Vector3d& target_m, double size_m);

 private:
  using Feedback = visualization_msgs::InteractiveMarkerFeedback;
  void on_feedback(const Feedback& feedback);
  void on_goal(const geometry_msgs::PoseStamped& goal);

  Moved moved_;
  std::mutex mutex_;  // guards what follows; held briefly
  std::string marker_;
  double size_m_ = 0.0;
  HeldTarget held_;

  tf2_ros::Buffer frames_;
  FrameListener listener_{frames_};
  interactive_markers::InteractiveMarkerServer server_;
  ros::Subscriber goals_;
};

}  // namespace soft_robot_lab
