#pragma once

#include "simulation_parts.h"
#include "soft_robot_lab/sim/solve_report.h"

namespace soft_robot_lab {

// A body at rest sleeps: its steps only let time pass, until a command, a constraint's law or the state changes.

// Of the present positions without motion.
double residual_at_rest(SimulationParts& parts);

// One step of a sleeping body; false where it is awake, or has just been woken.
bool sleep_on(SimulationParts& parts, double h, SolveReport& report);

// After a step of length h: has the next one make its own factor where the body is nearly still, far from where the last
// was made; sleeps from now on where nothing moves, every command is reached, and the body stands in a
// stable equilibrium to options.tolerance.
void fall_asleep_where_still(SimulationParts& parts, double h, const SolveReport& report);

}  // namespace soft_robot_lab
