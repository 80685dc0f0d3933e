// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simulation_parts.h"

namespace soft_robot_lab {

// To the stable rest state at the commands, in stages of the command change where one is too far; where it may go only
// through stable shapes, in one, or not at all.
void find_equilibrium(SimulationParts& parts, const EquilibriumOptions& options, SolveReport& report);

}  // namespace soft_robot_lab
