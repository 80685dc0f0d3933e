// SPDX-License-Identifier: BSD-3-Clause
// How a program asks a running session.
#pragma once

#include <stdexcept>
#include <string>

#include <boost/function.hpp>
#include <ros/callback_queue.h>
#include <ros/ros.h>

namespace soft_robot_lab {

// The next message, or, of a latched topic, the last; throws std::runtime_error where none comes within a minute of the
// wall's time. Not ros::topic::waitForMessage: that counts in /clock, which jumps as a node begins to hear it.
template <typename Message>
Message first_on(ros::NodeHandle& node, const std::string& topic) {
  ros::CallbackQueue queue;
  typename Message::ConstPtr heard;
  const boost::function<void(const typename Message::ConstPtr&)> keep = [&](const auto& message) { heard = message; };
  auto options = ros::SubscribeOptions::create<Message>(topic, 1, keep, ros::VoidPtr(), &queue);
  const ros::Subscriber subscriber = node.subscribe(options);
  const ros::WallTime limit = ros::WallTime::now() + ros::WallDuration(60.0);
  while (!heard && ros::ok() && ros::WallTime::now() < limit) queue.callAvailable(ros::WallDuration(0.1));
  if (!heard) throw std::runtime_error("nothing on " + topic + ": is there a session?");
  return *heard;
}

// Waits for the service; throws std::runtime_error where there is no answer within a minute, or the answer is no
// success.
template <typename Service>
typename Service::Response call(ros::NodeHandle& node, const char* name, const typename Service::Request& request) {
  ros::service::waitForService(name, 60000);
  typename Service::Response response;
  if (!node.serviceClient<Service>(name).call(request, response)) {
    throw std::runtime_error(std::string(name) + ": no answer");
  }
  if (!response.success) throw std::runtime_error(std::string(name) + ": " + response.message);
  return response;
}

}  // namespace soft_robot_lab
