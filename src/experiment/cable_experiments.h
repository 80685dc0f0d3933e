// The source's experiments with cables, named by its sections; each reads config/experiments/SECTION.yaml.
#pragma once

#include "soft_robot_lab/experiment/experiment.h"

namespace soft_robot_lab {

ExperimentResult run_cable_stiffness_experiment(const ExperimentContext& context);         // 4.3.2, hanging bar
ExperimentResult run_hammerbot_contractions_experiment(const ExperimentContext& context);  // 6.3.1
ExperimentResult run_spinebot_contractions_experiment(const ExperimentContext& context);   // 6.3.2
ExperimentResult run_pull_order_experiment(const ExperimentContext& context);              // 6.3.3, Hammerbot

}  // namespace soft_robot_lab
