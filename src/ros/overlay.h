// SPDX-License-Identifier: BSD-3-Clause
// What rviz draws over the body: markers, simulated and measured, and the gap between them, target, cables by tension,
// chambers' pressures, and the remaining error.
#pragma once

#include <optional>

#include <soft_robot_lab/RealityGap.h>
#include <visualization_msgs/MarkerArray.h>

#include "messages.h"

namespace soft_robot_lab {

struct OverlayInputs {
  MarkerObservations simulated;
  MarkerObservations measured;  // empty without a tracker
  ActuatorState actuators;
  std::optional<Target> target;
  std::optional<RealityGap> gap;
};

struct OverlayOptions {
  double marker_radius_m = 0.002;
  double target_radius_m = 0.004;
  double cable_width_m = 0.0012;
  double text_height_m = 0.004;
  double full_tension_n = 5.0;  // drawn red; none is drawn green
};

visualization_msgs::MarkerArray overlay_of(const OverlayInputs& inputs, const OverlayOptions& options,
                                           const ros::Time& stamp);

}  // namespace soft_robot_lab
