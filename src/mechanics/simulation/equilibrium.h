// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simulation_parts.h"

namespace soft_robot_lab {

// To the stable rest state at the commands, in stages of the command change where one is too far; where it may go only
// through stable shapes, in one, or not at all.
void find_equilibrium(SimulationParts& parts, const EquilibriumOptions& options, SolveReport& report);

// Whether the body may have met an obstacle or its own skin on the way from one state to the present one; each node is
// taken to go not much further than straight.
bool may_have_met(const SimulationParts& parts, const SimulationState& from);

}  // namespace soft_robot_lab
