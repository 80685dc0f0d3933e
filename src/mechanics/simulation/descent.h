// SPDX-License-Identifier: BSD-3-Clause
// To a rest state at fixed commands, from the present state.
#pragma once

#include "simulation_parts.h"

namespace soft_robot_lab {

// An equilibrium may take a multiple of max_iterations in all.
bool within_budget(const SimulationParts& parts, const SolveReport& report);

// Newton alone. Where it does not converge the state stays as it was.
bool relax(SimulationParts& parts, SolveReport& report, const EquilibriumOptions& options = {});

// The same after a fall down the energy (SimulationParts::solve_from_below).
bool relax_from_below(SimulationParts& parts, SolveReport& report);

// Whether the body would be free to move as a whole without contact, and contact has friction.
bool held_by_friction_alone(const SimulationParts& parts);

// Down the energy in steps that inertia keeps short, longer and longer (pseudo-transient continuation, Kelley & Keyes
// 1998), until inertia has no say and Newton alone converges: finds its way through buckling, where a rest state that
// Newton would run to is a saddle. Where it fails the state is the furthest it came. A body that slides away beyond
// what friction holds ends it, with a message that names the obstacles.
bool descend(SimulationParts& parts, SolveReport& report);

}  // namespace soft_robot_lab
