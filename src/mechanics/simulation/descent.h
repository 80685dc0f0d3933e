// SPDX-License-Identifier: BSD-3-Clause
// To a rest state at fixed commands, from the present state.
#pragma once

#include "ballooning.h"
#include "mechanics/solver_constants.h"
#include "simulation_parts.h"

namespace soft_robot_lab {

// What a search for a rest state found: one that is a minimum of the energy, one that is not, or none.
enum class RestFound { stable, saddle, none, beyond };  // the last: on a way that may be too far for one stage

// Newton alone. Only a stable rest state becomes the state; else it stays as it was.
RestFound relax(SimulationParts& parts, SolveReport& report, const EquilibriumOptions& options = {},
                int most_iterations = constants::kStageIterations);

// The same after a fall down the energy (SimulationParts::solve_from_below).
RestFound relax_from_below(SimulationParts& parts, SolveReport& report);

// Whether the body would be free to move as a whole without contact, and contact has friction.
bool held_by_friction_alone(const SimulationParts& parts);

// Down the energy in steps that inertia keeps short, longer and longer (pseudo-transient continuation, Kelley & Keyes
// 1998), until inertia has no say and Newton alone converges: finds its way through buckling, where a rest state that
// Newton would run to is a saddle. Where it fails the state is the furthest it came. A body that slides away beyond
// what friction holds ends it, with a message that names the obstacles; a chamber that balloons too.
bool descend(SimulationParts& parts, SolveReport& report, const Ballooning& ballooning);

// A small way along what the present rest state resists least, to the side that `way_m` has led to; where that has led
// to neither, to a side that a fixed rule chooses. Cut where it would go into obstacles or other skin. 3 x nodes; empty
// where there is no factor.
struct Nudge {
  Eigen::Matrix3Xd motion_m;
  bool other_side = false;  // which is as easy
  bool unstable = false;    // what gives way is far softer than the softest motion of the rest shape
};
Nudge nudge_off(SimulationParts& parts, const Eigen::Matrix3Xd& way_m);

}  // namespace soft_robot_lab
