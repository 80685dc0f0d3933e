// SPDX-License-Identifier: BSD-3-Clause
// What a running simulation shows on its topics: the state of each step, and skin and obstacles where they moved.
#pragma once

#include <atomic>
#include <vector>

#include <Eigen/Geometry>
#include <ros/ros.h>

#include "ros/display/surface_marker.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

class SimulationPublisher {
 public:
  // Skin and obstacles are shown at most `surface_rate_hz` times in a second of the session [Hz].
  SimulationPublisher(double surface_rate_hz, bool publish_clock);

  // Shows another scene's obstacles at once, and its skin with the next state.
  void show(const Simulation& simulation, const ros::Time& stamp);
  void publish(const Simulation& simulation, SurfaceMarker& surface, const ros::Time& stamp);

 private:
  void publish_state(const Simulation& simulation, const ros::Time& stamp);
  void publish_surface(const Simulation& simulation, SurfaceMarker& surface, const ros::Time& stamp);
  void publish_contact(const Simulation& simulation, const ros::Time& stamp);

  double surface_rate_hz_;
  double surface_period_ = -1.0;  // number of the period of session time in which it was last published
  double obstacles_period_ = -1.0;
  std::vector<Eigen::Isometry3d> obstacles_shown_;
  std::atomic<bool> show_again_{false};  // to a new subscriber: shows both again, though they may not move

  ros::NodeHandle node_;
  ros::Publisher clock_, markers_, actuators_, joints_, reaction_, surface_, contacts_, obstacles_;
};

}  // namespace soft_robot_lab
