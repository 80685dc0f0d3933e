// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "study/experiment.h"

namespace soft_robot_lab {

ExperimentResult run_tracking_experiment(const ExperimentContext& context);
ExperimentResult run_contrast_segmentation_experiment(const ExperimentContext& context);
ExperimentResult run_colour_segmentation_experiment(const ExperimentContext& context);

}  // namespace soft_robot_lab
