// SPDX-License-Identifier: BSD-3-Clause
// What tests of running sessions hear and ask.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>

#include <ros/ros.h>

namespace soft_robot_lab {

template <typename Condition>
bool spin_until(const Condition& condition, double limit_s = 20.0) {
  const ros::WallTime limit = ros::WallTime::now() + ros::WallDuration(limit_s);
  while (!condition()) {  // asked once: it may look at the next frame each time
    if (ros::WallTime::now() >= limit) return false;
    ros::spinOnce();
    ros::WallDuration(0.002).sleep();
  }
  return true;
}

template <typename Condition>
void wait_for(const std::string& what, const Condition& reached) {
  if (!spin_until(reached, 30.0)) throw std::runtime_error("waited in vain for " + what);
}

// The next message, or, of a latched topic, the last.
template <typename Message>
typename Message::ConstPtr hear(ros::NodeHandle& node, const std::string& topic) {
  std::optional<typename Message::ConstPtr> heard;
  const ros::Subscriber subscriber = node.subscribe<Message>(
      topic, 1, boost::function<void(const typename Message::ConstPtr&)>([&](const auto& m) { heard = m; }));
  if (!spin_until([&] { return heard.has_value(); })) throw std::runtime_error("nothing on " + topic);
  return *heard;
}

template <typename Service>
typename Service::Response ask(ros::NodeHandle& node, const std::string& name,
                               const typename Service::Request& request = {}) {
  if (!ros::service::waitForService(name, 20000)) throw std::runtime_error("no service " + name);
  typename Service::Response response;
  for (int attempt = 0; attempt < 2; ++attempt)  // a busy machine may lose a connection
    if (node.serviceClient<Service>(name).call(request, response)) return response;
  throw std::runtime_error("no answer of " + name);
}

}  // namespace soft_robot_lab
