// SPDX-License-Identifier: BSD-3-Clause
// A fit to poses in time: all numbers at once, with those of creep. Where cables rub, how a robot swung on its way
// decides where it rests, and creep moves it still while it is seen.
#pragma once

#include <string>
#include <vector>

#include "fit_parameters.h"

namespace soft_robot_lab {

// `unknowns`: where parameters.numbers() start, found by rest states; creep starts as the scene has it. Throws as
// SightFit does, and std::invalid_argument where the time that commands were held is not known, or too few markers were
// seen meanwhile.
FitResult fit_in_time(const FitParameters& parameters, const std::string& scene, const SceneOptions& options,
                      const std::vector<MeasuredPose>& poses, const FitRequest& request, std::vector<double> unknowns);

}  // namespace soft_robot_lab
