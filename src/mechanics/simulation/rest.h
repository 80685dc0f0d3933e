// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simulation_parts.h"
#include "soft_robot_lab/mechanics/solve_report.h"

namespace soft_robot_lab {

// A body at rest sleeps: its steps only let time pass, until a command, a constraint's law or the state changes.

// Of the present positions without motion.
double residual_at_rest(const SimulationParts& parts);

// Throws std::runtime_error where the present state is no equilibrium, and so has no derivative.
void require_rest(const SimulationParts& parts);

// One step of a sleeping body; false where it is awake, or has just been woken.
bool sleep_on(SimulationParts& parts, double h, SolveReport& report);

// After a step of length h: sleeps from now on where nothing is faster than 1e-4 of the body's size a second, every
// command is reached, and the body stands in a stable equilibrium to options.tolerance. Where it is only nearly still,
// far from where the last factor was made, the next step makes its own.
void fall_asleep_where_still(SimulationParts& parts, double h, const SolveReport& report);

}  // namespace soft_robot_lab
