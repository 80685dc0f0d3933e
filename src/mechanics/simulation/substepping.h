// SPDX-License-Identifier: BSD-3-Clause
// Time steps and rest states by xpbd.
#pragma once

#include "simulation_parts.h"

namespace soft_robot_lab {

void step_in_substeps(SimulationParts& parts, SolveReport& report);

// By sweeps without inertia, where nothing but commands moves the body and it meets nothing. Sweeps remember nothing of
// the way, and leave no saddle: all else, and what they do not find, is sought along the path of `find_equilibrium`.
void settle_in_substeps(SimulationParts& parts, const EquilibriumOptions& options, SolveReport& report);

}  // namespace soft_robot_lab
