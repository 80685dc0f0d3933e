// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "study/experiment.h"

namespace soft_robot_lab {

ExperimentResult run_hammerbot_gap_experiment(const ExperimentContext& context);  // 6.4.1
ExperimentResult run_spinebot_gap_experiment(const ExperimentContext& context);   // 6.4.2
ExperimentResult run_bubblebot_gap_experiment(const ExperimentContext& context);  // 6.4.3

}  // namespace soft_robot_lab
