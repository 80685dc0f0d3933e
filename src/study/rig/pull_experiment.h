// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "study/experiment.h"

namespace soft_robot_lab {

// Section 4.3.1 of the thesis: pulls of several lengths, each some times, and a line through their times.
ExperimentResult run_pull_experiment(const ExperimentContext& context);

}  // namespace soft_robot_lab
