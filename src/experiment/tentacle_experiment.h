#pragma once

#include "soft_robot_lab/experiment/experiment.h"

namespace soft_robot_lab {

ExperimentResult run_tentacle_experiment(const ExperimentContext& context);

}  // namespace soft_robot_lab
