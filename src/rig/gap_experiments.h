#pragma once

#include "soft_robot_lab/experiment/experiment.h"

namespace soft_robot_lab {

ExperimentResult run_hammerbot_gap_experiment(const ExperimentContext& context);  // 6.4.1
ExperimentResult run_spinebot_gap_experiment(const ExperimentContext& context);   // 6.4.2

}  // namespace soft_robot_lab
