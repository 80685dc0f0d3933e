// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>
#include <visualization_msgs/MarkerArray.h>

#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

// The shapes of a scene's obstacles where they stand, instead of all that were shown before; a plane as a sheet four
// times as wide as the robot. Free ones have a colour of their own.
visualization_msgs::MarkerArray obstacle_markers(const Simulation& simulation, const ros::Time& stamp);

}  // namespace soft_robot_lab
