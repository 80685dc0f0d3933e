// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

// Which key of the actuator in its scene moves its least or its greatest command, as the end of a message about a
// command beyond that: "; min_beta of 'air' moves that limit". Empty where none does.
std::string limit_hint(const Simulation& simulation, int actuator, bool least);

}  // namespace soft_robot_lab
