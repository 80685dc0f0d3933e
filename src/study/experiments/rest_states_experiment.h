// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "study/experiment.h"

namespace soft_robot_lab {

ExperimentResult run_rest_states_experiment(const ExperimentContext& context);

}  // namespace soft_robot_lab
