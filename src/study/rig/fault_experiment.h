// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "study/experiment.h"

namespace soft_robot_lab {

// Random commands over a line that damages bytes, with unplugging and resets: what became of commands and positions.
ExperimentResult run_fault_experiment(const ExperimentContext& context);

}  // namespace soft_robot_lab
