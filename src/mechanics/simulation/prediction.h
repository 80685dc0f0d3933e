// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mechanics/state/backward_difference.h"
#include "mechanics/newton/newton_solver.h"
#include "soft_robot_lab/mechanics/simulation_state.h"

namespace soft_robot_lab {

// Where a time step of length h starts its search: along a parabola where the motion is smooth, else along the
// velocity. The nearer it starts, the longer an old factor serves.
NewtonState predict(const SimulationState& state, double h, StepRule rule);

}  // namespace soft_robot_lab
