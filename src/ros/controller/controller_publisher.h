// SPDX-License-Identifier: BSD-3-Clause
// What the controller sends: commands, answers to a target that was let go, and the shapes that a policy and commands
// lead to.
#pragma once

#include <string>
#include <vector>

#include <ros/ros.h>
#include <soft_robot_lab/OptimisePolicyResult.h>
#include <visualization_msgs/Marker.h>

#include "ros/base/latched_publisher.h"
#include "ros/base/topics.h"

namespace soft_robot_lab {

class ControllerPublisher {
 public:
  explicit ControllerPublisher(ros::NodeHandle& node);

  // `values` as `names`, each in the unit of its actuator's command.
  void send(const std::vector<std::string>& names, const std::vector<double>& values) const;
  void answer(const OptimisePolicyResult& result) const { answers_.publish(result); }

  void show_ghost(const visualization_msgs::Marker& skin);
  void remove_ghost();
  void show_preview(const visualization_msgs::Marker& skin);
  void remove_preview();
  void show_path(const visualization_msgs::Marker& path) { path_.publish(path); }
  bool preview_is_watched() const { return preview_.has_subscribers(); }

 private:
  ros::Publisher commands_, answers_;
  PresentPublisher<visualization_msgs::Marker> ghost_{topics::controller_ghost}, preview_{topics::controller_preview},
      path_{topics::controller_path};
};

}  // namespace soft_robot_lab
