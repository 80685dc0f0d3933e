// SPDX-License-Identifier: BSD-3-Clause
// How a node of this package starts and ends.
#pragma once

#include <exception>
#include <string>

#include <ros/ros.h>

namespace soft_robot_lab {

// Runs `run` after ROS has been set up; what it throws is written to the log, and gives the exit status 2.
template <class Run>
int run_node(int argc, char** argv, const std::string& name, Run run) {
  ros::init(argc, argv, name);
  const ros::NodeHandle keeps_the_log_open;  // without any, a failure could not be logged
  try {
    run();
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 2;
  }
  return 0;
}

}  // namespace soft_robot_lab
