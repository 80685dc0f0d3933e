// SPDX-License-Identifier: BSD-3-Clause
// What a session publishes once, and again to each new subscriber: its frames, and which scene and solver run.
#pragma once

#include <string>

#include <Eigen/Core>
#include <soft_robot_lab/ActuatorRanges.h>
#include <std_msgs/String.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include "ros/base/latched_publisher.h"
#include "ros/base/topics.h"

namespace soft_robot_lab {

class SceneAnnouncement {
 public:
  // `position_m`: of the session in the room. Throws std::invalid_argument where it is not zero in a session that has
  // no namespace.
  void announce_frames(const Eigen::Vector3d& position_m);
  void announce(const std::string& path, const ActuatorRanges& ranges);
  void announce_solver(const std::string& solver);

 private:
  LatchedPublisher<std_msgs::String> scene_path_{topics::simulator_scene};
  LatchedPublisher<ActuatorRanges> ranges_{topics::simulator_ranges};
  PresentPublisher<std_msgs::String> solver_{topics::simulator_solver};
  tf2_ros::StaticTransformBroadcaster frames_;
};

}  // namespace soft_robot_lab
