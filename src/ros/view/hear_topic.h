// SPDX-License-Identifier: BSD-3-Clause
// How our rviz displays hear a topic.
#pragma once

#include <string>

#include <boost/function.hpp>
#include <ros/node_handle.h>
#include <rviz/display.h>

namespace soft_robot_lab {

// While the display is enabled and `topic` has a name, `take` gets its messages; its status "Topic" says how it went.
template <typename Message, typename Take>
ros::Subscriber hear_topic(rviz::Display& display, ros::NodeHandle& node, const std::string& topic, const Take& take) {
  if (!display.isEnabled() || topic.empty()) return {};
  try {
    const boost::function<void(const typename Message::ConstPtr&)> take_one = [take](const auto& m) { take(*m); };
    const ros::Subscriber subscriber = node.subscribe<Message>(topic, 2, take_one);
    display.setStatus(rviz::StatusProperty::Ok, "Topic", "OK");
    return subscriber;
  } catch (const ros::Exception& error) {
    display.setStatus(rviz::StatusProperty::Error, "Topic", error.what());
    return {};
  }
}

}  // namespace soft_robot_lab
