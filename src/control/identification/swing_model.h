// SPDX-License-Identifier: BSD-3-Clause
// How a scene says that a measured swing goes.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/control/identification/fit_model.h"

namespace soft_robot_lab {

class SimulatedSwing {
 public:
  // Places of markers at even times from start_s on; nothing moved the robot but itself after free_s.
  SimulatedSwing(double start_s, double step_s, double free_s, std::vector<Eigen::Matrix3Xd> markers_m)
      : start_s_(start_s), step_s_(step_s), free_s_(free_s), markers_m_(std::move(markers_m)) {}

  double free_s() const { return free_s_; }
  // Between steps by the cubic through the four around (Catmull & Rom 1974). From where it ends.
  Eigen::Vector3d deflection_m(int marker, double time_s) const;
  Eigen::Vector3d velocity_m_s(int marker, double time_s) const;

 private:
  Eigen::Vector3d cubic(int marker, double time_s, bool derivative) const;

  double start_s_, step_s_, free_s_;
  std::vector<Eigen::Matrix3Xd> markers_m_;
};

// Each simulated until window_s after nothing moves it any more. Throws std::invalid_argument for names that the
// simulation does not know, std::runtime_error where it finds no rest to start from.
std::vector<SimulatedSwing> simulate_swings(Simulation& simulation, const std::vector<MeasuredSwing>& swings,
                                            double window_s);

}  // namespace soft_robot_lab
