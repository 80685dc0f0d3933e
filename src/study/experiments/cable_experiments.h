// SPDX-License-Identifier: BSD-3-Clause
// Experiments with cables: the source's, named by its sections, and ours. Each reads config/experiments/NAME.yaml.
#pragma once

#include "study/experiment.h"

namespace soft_robot_lab {

ExperimentResult run_cable_stiffness_experiment(const ExperimentContext& context);           // 4.3.2, hanging bar
ExperimentResult run_hammerbot_configurations_experiment(const ExperimentContext& context);  // 6.3.1
ExperimentResult run_spinebot_configurations_experiment(const ExperimentContext& context);   // 6.3.2
ExperimentResult run_pull_order_experiment(const ExperimentContext& context);                // 6.3.3
ExperimentResult run_hammerbot_workspace_experiment(const ExperimentContext& context);       // workspace_hammerbot
ExperimentResult run_spinebot_workspace_experiment(const ExperimentContext& context);        // workspace_spinebot
ExperimentResult run_via_points_experiment(const ExperimentContext& context);                // via_points, held bar
ExperimentResult run_pseudo_inverse_experiment(const ExperimentContext& context);            // pseudo_inverse, bar

}  // namespace soft_robot_lab
