// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simulation_parts.h"

namespace soft_robot_lab {

// One time step of length h by implicit Euler or bdf2, in halves where it does not converge.
void step_in_time(SimulationParts& parts, double h, SolveReport& report);

}  // namespace soft_robot_lab
