// SPDX-License-Identifier: BSD-3-Clause
// Which of the measured swings identify a robot's damping, and what of them.
#pragma once

#include <string>
#include <vector>

#include "swing_model.h"

namespace soft_robot_lab {

constexpr double kSwingWindow_s = 2.0;        // of a swing no more counts
constexpr double kSwingDelayMargin_s = 0.05;  // to which a delay is known at first

// A marker in a swing.
struct SwingTrack {
  std::size_t swing = 0;
  int marker = 0;  // in the scene
  std::vector<double> times_s;
  std::vector<MeasuredMarker> measured;
  double free_s = 0.0;    // since when nothing moves the robot, simulated
  double middle_s = 0.0;  // of the window
  double fraction(double time_s) const { return (time_s - middle_s) / (0.5 * kSwingWindow_s); }
};

struct ChosenSwings {
  std::vector<MeasuredSwing> swings;
  std::vector<double> delays_s;  // of drives and cameras behind the commands, one per swing
  std::vector<SwingTrack> tracks;
};

// Those few in which a marker moves farthest, measured as well as simulated, in deviations of its noise; none where it
// is less than one. Throws as simulate_swings does, and std::invalid_argument for numbers that are not finite.
ChosenSwings choose_swings(Simulation& simulation, const std::vector<MeasuredSwing>& swings, double model_error_m);

}  // namespace soft_robot_lab
