// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "soft_robot_lab/control/identification/fit_model.h"
#include "study/experiment.h"

namespace soft_robot_lab {

// The emulated robot goes through a table, held at each configuration and filmed while it creeps. What a fit finds in
// this recording, beside what plant.yaml hides; then poses that the fit has not seen.
ExperimentResult run_fit_rig_experiment(const ExperimentContext& context);

// The fit alone; its overrides are over the robot's own file.
FitResult fit_emulated_rig(const ExperimentContext& context);

}  // namespace soft_robot_lab
