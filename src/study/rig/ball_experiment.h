// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "study/experiment.h"

namespace soft_robot_lab {

ExperimentResult run_source_ball_experiment(const ExperimentContext& context);  // 7.3.3
ExperimentResult run_ball_experiment(const ExperimentContext& context);         // the demonstration's

}  // namespace soft_robot_lab
