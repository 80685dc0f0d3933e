// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "study/experiment.h"

namespace soft_robot_lab {

// Robots that are pulled out of rigid moulds, with friction and suction.
ExperimentResult run_demoulding_experiment(const ExperimentContext& context);

}  // namespace soft_robot_lab
