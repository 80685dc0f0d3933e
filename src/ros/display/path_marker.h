// SPDX-License-Identifier: BSD-3-Clause
// A planned path as lines for rviz.
#pragma once

#include <visualization_msgs/Marker.h>

#include "soft_robot_lab/control/motion/plan_motion.h"

namespace soft_robot_lab {

// The curve, green where the marker can reach it within the tolerance and red elsewhere; grey, where the model's marker
// goes in time.
visualization_msgs::Marker path_marker(const PathPlan& plan, double tolerance_m);
// Takes it away.
visualization_msgs::Marker no_path();

}  // namespace soft_robot_lab
