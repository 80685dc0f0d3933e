// SPDX-License-Identifier: BSD-3-Clause
// The experiments with the rig, for the program `experiment`: they run the real firmware on the emulated board.
#pragma once

#include <vector>

#include "study/experiment.h"

namespace soft_robot_lab {

std::vector<Experiment> rig_experiments();

}  // namespace soft_robot_lab
