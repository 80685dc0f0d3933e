// SPDX-License-Identifier: BSD-3-Clause
// The damping by which a simulated robot's swings die away as the measured ones do.
#pragma once

#include <string>
#include <vector>

#include "fit_parameters.h"

namespace soft_robot_lab {

// Adds what is found to `result`, whose changes are laid over the scene: value, correlations, warnings, changes,
// swings.
//
// Of each swing its extent, its delay, its tempo and each coordinate's mean and drift (creep) are unknowns too: neither
// how far drives pulled nor how stiff the robot is shall pass for damping. Unknown is the logarithm of the damping; its
// derivative is the difference of two motions, as an exact one would take a factorisation in every step, and so longer.
void fit_damping(const std::string& scene, const SceneOptions& options, const std::vector<MeasuredSwing>& swings,
                 const FitNumber& number, const FitRequest& request, FitResult& result);

}  // namespace soft_robot_lab
