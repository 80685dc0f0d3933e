// SPDX-License-Identifier: BSD-3-Clause
#include "frame_listener.h"

#include <tf2/exceptions.h>

#include "log_text.h"

namespace soft_robot_lab {

FrameListener::FrameListener(tf2::BufferCore& frames) : frames_(frames) {
  using Event = ros::MessageEvent<const tf2_msgs::TFMessage>;
  const auto listen = [this](const std::string& topic, bool fixed) {
    return node_.subscribe<tf2_msgs::TFMessage>(
        topic, 100, boost::function<void(const Event&)>([this, fixed](const Event& event) { hear(event, fixed); }));
  };
  moving_ = listen("/tf", false);
  fixed_ = listen("/tf_static", true);
}

void FrameListener::hear(const ros::MessageEvent<const tf2_msgs::TFMessage>& event, bool fixed) {
  if (!fixed) follow_clock();
  for (const auto& transform : event.getConstMessage()->transforms) {
    try {
      frames_.setTransform(transform, event.getPublisherName(), fixed);
    } catch (const tf2::TransformException& error) {
      ROS_ERROR_THROTTLE(10, "frame refused: %s", log_text(error.what()).c_str());
    }
  }
}

void FrameListener::follow_clock() {
  const ros::Time now = ros::Time::now();
  if (now < heard_) frames_.clear();
  heard_ = now;
}

}  // namespace soft_robot_lab
