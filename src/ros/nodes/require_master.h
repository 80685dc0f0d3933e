// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

#include <ros/ros.h>

namespace soft_robot_lab {

// Throws std::runtime_error where no master answers within `limit_s`: ROS itself would wait for ever.
inline void require_master(double limit_s = 10.0) {
  const ros::WallTime limit = ros::WallTime::now() + ros::WallDuration(limit_s);
  while (!ros::master::check()) {
    if (ros::WallTime::now() > limit)
      throw std::runtime_error("no ROS master answers at " + ros::master::getURI() +
                               "; a launch file or roscore starts one, ROS_MASTER_URI names it");
    ros::WallDuration(0.2).sleep();
  }
}

}  // namespace soft_robot_lab
