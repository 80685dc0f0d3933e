#pragma once

#include "soft_robot_lab/experiment/experiment.h"

namespace soft_robot_lab {

ExperimentResult run_fit_experiment(const ExperimentContext& context);

}  // namespace soft_robot_lab
