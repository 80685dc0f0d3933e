// SPDX-License-Identifier: BSD-3-Clause
// How far the sheaths of a robot bend in use.
#pragma once

#include "sheaths.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

// The smallest radius through three points of a path, each `step_m` from the next along it; infinite for a straight
// path and for one shorter than two steps.
WorstAlong tightest_arc(const SheathPath& path, double step_m);

// The tightest arc of all sheaths at rest states where one cable after the other is pulled as far as its limits allow,
// the others at rest: where they run in the solid, by steps of six radii. `other` is the cable that is pulled. A
// command without a rest state is left out; there is none where an actuator knows no equilibrium. The simulation is
// reset, before and afterwards.
WorstAlong tightest_moved_bend(Simulation& simulation, const RayTree& solid, const std::vector<SheathPath>& sheaths);

}  // namespace soft_robot_lab
