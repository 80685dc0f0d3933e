// SPDX-License-Identifier: BSD-3-Clause
// The process of a node, for tests that kill it.
#pragma once

#include <csignal>
#include <stdexcept>
#include <string>

#include <ros/master.h>
#include <ros/network.h>
#include <ros/ros.h>
#include <xmlrpcpp/XmlRpc.h>

namespace soft_robot_lab {

inline pid_t process_of(const std::string& node) {
  const ros::WallTime limit = ros::WallTime::now() + ros::WallDuration(30.0);
  XmlRpc::XmlRpcValue request, response, process;
  request[0] = request[1] = node;
  std::string host;
  std::uint32_t port = 0;
  while (ros::WallTime::now() < limit) {
    if (ros::master::execute("lookupNode", request, response, process, false) &&
        ros::network::splitURI(process, host, port)) {
      XmlRpc::XmlRpcClient client(host.c_str(), static_cast<int>(port), "/");
      if (client.execute("getPid", request, response) && static_cast<int>(response[0]) == 1)
        return static_cast<int>(response[2]);
    }
    ros::WallDuration(0.1).sleep();
  }
  throw std::runtime_error("nobody knows the process of " + node);
}

}  // namespace soft_robot_lab
