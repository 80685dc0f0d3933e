// SPDX-License-Identifier: BSD-3-Clause
// How a program asks a running session.
#pragma once

#include <stdexcept>
#include <string>

#include <ros/ros.h>

namespace soft_robot_lab {

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
