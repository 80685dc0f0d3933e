// SPDX-License-Identifier: BSD-3-Clause
// Time steps and rest states by xpbd.
#pragma once

#include "simulation_parts.h"

namespace soft_robot_lab {

void step_in_substeps(SimulationParts& parts, SolveReport& report);

// Dynamic relaxation with kinetic damping (Cundall 1976): motion stops whenever it has begun to slow down.
void settle_in_substeps(SimulationParts& parts, SolveReport& report);

}  // namespace soft_robot_lab
