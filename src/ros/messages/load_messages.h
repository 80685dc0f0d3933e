// SPDX-License-Identifier: BSD-3-Clause
// Estimated loads as messages, and as rviz shows them.
#pragma once

#include <string>
#include <vector>

#include <soft_robot_lab/TwinLoads.h>
#include <visualization_msgs/MarkerArray.h>

#include "messages.h"
#include "control/estimation/load_estimator.h"

namespace soft_robot_lab {

// What cameras saw, and nothing that was estimated. Throws std::invalid_argument as require_whole, and where there are
// not 9 covariances for each marker.
std::vector<MeasuredMarker> measured_markers(const MarkerObservations& markers);

TwinLoads load_message(const LoadEstimate& estimate, const ros::Time& stamp);
MarkerObservations estimated_markers(const LoadEstimate& estimate, const ros::Time& stamp);

// "pushed by 43 mN at (1, -8, -60) mm, +-6 mN".
std::string describe(const LoadEstimate& estimate);

// Of each load an arrow that ends where it acts, its size in words, and an ellipsoid of one standard deviation of that
// place. Takes away what earlier ones showed.
visualization_msgs::MarkerArray load_arrows(const LoadEstimate& estimate, double size_m, const ros::Time& stamp);

}  // namespace soft_robot_lab
