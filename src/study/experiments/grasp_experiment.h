// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "study/experiment.h"

namespace soft_robot_lab {

// A gripper that is shaken, over the friction of its fingers on a ball.
ExperimentResult run_grasp_experiment(const ExperimentContext& context);

}  // namespace soft_robot_lab
