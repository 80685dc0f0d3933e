// SPDX-License-Identifier: BSD-3-Clause
// The source's experiments with air chambers, named by its sections; each reads config/experiments/SECTION.yaml.
#pragma once

#include "study/experiment.h"

namespace soft_robot_lab {

ExperimentResult run_inflation_experiment(const ExperimentContext& context);     // 5.3.1, hollow cuboid
ExperimentResult run_deflation_experiment(const ExperimentContext& context);     // 5.3.2, hollow cuboid
ExperimentResult run_bubblefinger_experiment(const ExperimentContext& context);  // 6.3.4
ExperimentResult run_bubblebot_experiment(const ExperimentContext& context);     // 6.3.5

}  // namespace soft_robot_lab
