// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "study/experiment.h"

namespace soft_robot_lab {

// Reference R1: the bar of config/scenes/cantilever.yaml at each Poisson's ratio of the reference, by each element.
ExperimentResult run_cantilever_experiment(const ExperimentContext& context);

}  // namespace soft_robot_lab
