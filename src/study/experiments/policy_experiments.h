// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "study/experiment.h"

namespace soft_robot_lab {

ExperimentResult run_random_targets_experiment(const ExperimentContext& context);  // 7.3.1
ExperimentResult run_pid_experiment(const ExperimentContext& context);             // 7.3.2

}  // namespace soft_robot_lab
