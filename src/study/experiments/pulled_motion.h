// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

struct CablePull {
  double left = 1, right = 1;  // contractions of the first and the second actuator
};

// Where a moving robot is at one frame of a film, and a little before.
struct Moment {
  double time_s = 0;
  SimulationState previous, present;
};

// Gives each pull in its turn, from rest under gravity, and keeps the robot's states at `rate_hz` as it moves; the
// simulation takes two steps a frame, so its time step has to be 1 / (2 rate_hz). Throws std::runtime_error where the
// rest state cannot be found.
std::vector<Moment> move_through(Simulation& simulation, const std::vector<CablePull>& pulls, double hold_s,
                                 double rate_hz);

}  // namespace soft_robot_lab
