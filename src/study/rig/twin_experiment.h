// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "study/experiment.h"

namespace soft_robot_lab {

// Emulated robots are pushed at random places and hung with weights; what a model fitted to them before makes of it by
// tracked markers: place, force, how sure it is, and how often it is wrong.
ExperimentResult run_twin_experiment(const ExperimentContext& context);

}  // namespace soft_robot_lab
