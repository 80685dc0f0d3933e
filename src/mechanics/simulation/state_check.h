// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "soft_robot_lab/mechanics/simulation_state.h"

namespace soft_robot_lab {

// Throws std::invalid_argument where a state to restore is not finite or does not fit one of the same simulation.
void check_state(const SimulationState& state, const SimulationState& now);

}  // namespace soft_robot_lab
