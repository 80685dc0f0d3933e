// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "study/experiment.h"

namespace soft_robot_lab {

// Bubblebot reaches for places by its three syringes: policies of the model, played on the emulated rig.
ExperimentResult run_air_policy_experiment(const ExperimentContext& context);

}  // namespace soft_robot_lab
