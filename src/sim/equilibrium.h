#pragma once

#include "simulation_parts.h"

namespace soft_robot_lab {

// To the stable rest state at the commands, in stages of the command change where one is too far.
void find_equilibrium(SimulationParts& parts, SolveReport& report);

}  // namespace soft_robot_lab
