// SPDX-License-Identifier: BSD-3-Clause
// What rviz draws over the body: markers, simulated and measured, with the trail of the tip and an ellipsoid for how
// sure the tracker is, and the gap between them, target, cables by tension, chambers' pressures, contacts' forces and
// areas, and the remaining error.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include <soft_robot_lab/RealityGap.h>
#include <visualization_msgs/MarkerArray.h>

#include "ros/messages/messages.h"

namespace soft_robot_lab {

struct OverlayInputs {
  MarkerObservations simulated;
  MarkerObservations measured;  // empty without a tracker
  ActuatorState actuators;
  std::optional<Target> target;
  std::optional<RealityGap> gap;
  Contacts contacts;
};

// Labels: texts at the places that they name, and what overlay_names.h lists. A window of its own lays them out.
struct DrawnOverlay {
  visualization_msgs::MarkerArray shapes, labels;
};

// Of what is shown: by namespace and name.
using OverlayNumbers = std::map<std::pair<std::string, std::string>, int>;

struct OverlayOptions {
  double marker_radius_m = 0.002;
  double target_radius_m = 0.004;
  double cable_width_m = 0.0012;
  double text_height_m = 0.004;
  double trail_s = 10.0;        // how long the way of `tip`, or else of the last marker, is seen
  double arrow_m_n = 0.03;      // length of a contact's arrow, per force
  double full_tension_n = 1.0;  // the least end of the scale of tensions, which grows with what is seen
};

// Where a marker went; forgets what is older than asked for, and all where time goes back.
class Trail {
 public:
  void add(const MarkerObservations& markers, double now_s, double kept_s);
  const std::deque<std::pair<double, geometry_msgs::Point>>& points() const { return points_; }  // of rising times [s]

 private:
  std::string marker_;
  std::deque<std::pair<double, geometry_msgs::Point>> points_;
};

class Overlay {
 public:
  explicit Overlay(const OverlayOptions& options = {}) : options_(options) {}

  // All shapes of now. A shape keeps its number as long as it is drawn, so that rviz moves it and nothing takes the
  // place of a marker that hides; what is not drawn any more is deleted. Throws std::invalid_argument for what is not
  // finite or not whole; then the next drawing follows the one before.
  DrawnOverlay draw(const OverlayInputs& inputs, const ros::Time& stamp);

  // Trails and scale begin anew, as another robot's.
  void forget();

 private:
  OverlayOptions options_;
  OverlayNumbers shown_;
  Trail simulated_trail_, measured_trail_;
  int next_ = 0;
  double full_tension_n_ = 0.0;  // the end of the scale: 1, 2 or 5 times a power of ten
};

}  // namespace soft_robot_lab
