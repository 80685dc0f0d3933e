// SPDX-License-Identifier: BSD-3-Clause
// Keeps the frames that a session sends. As tf2_ros::TransformListener does, which ends its node where the clock goes
// back by more than 2^31 s, since it takes the difference of two times.
#pragma once

#include <ros/ros.h>
#include <tf2/buffer_core.h>
#include <tf2_msgs/TFMessage.h>

namespace soft_robot_lab {

class FrameListener {
 public:
  // Fills `frames` from whatever threads serve the node's topics; a clock that goes back empties it of moving frames.
  explicit FrameListener(tf2::BufferCore& frames);

 private:
  void hear(const ros::MessageEvent<const tf2_msgs::TFMessage>& event, bool fixed);
  void follow_clock();

  tf2::BufferCore& frames_;
  ros::Time heard_;
  ros::NodeHandle node_;
  ros::Subscriber moving_, fixed_;
};

}  // namespace soft_robot_lab
