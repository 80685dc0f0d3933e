// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "study/experiment.h"

namespace soft_robot_lab {

// config/experiments/paths.yaml. Throws as EmulatedLab and fit_model do.
ExperimentResult run_paths_experiment(const ExperimentContext& context);

}  // namespace soft_robot_lab
