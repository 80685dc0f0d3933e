#pragma once

#include "soft_robot_lab/experiment/experiment.h"

namespace soft_robot_lab {

ExperimentResult run_random_targets_experiment(const ExperimentContext& context);
ExperimentResult run_convergence_experiment(const ExperimentContext& context);

}  // namespace soft_robot_lab
