// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "study/experiment.h"

namespace soft_robot_lab {

// A search for castable designs that reach farther than the robot of record; the best one's mould is made. Its journal
// stays in the output folder: the same command goes on where it was stopped.
ExperimentResult run_design_spinebot_experiment(const ExperimentContext& context);

}  // namespace soft_robot_lab
