#pragma once

#include "soft_robot_lab/experiment/experiment.h"

namespace soft_robot_lab {

ExperimentResult run_tracking_experiment(const ExperimentContext& context);
ExperimentResult run_segmentation_at_rest_experiment(const ExperimentContext& context);
ExperimentResult run_segmentation_in_motion_experiment(const ExperimentContext& context);

}  // namespace soft_robot_lab
