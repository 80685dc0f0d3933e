// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "speed_measurement.h"

namespace soft_robot_lab {

// Error over CPU time of one problem at one Poisson's ratio: ours series by series, Bullet's best, and what others say.
// Settled runs, or equilibria; the plot has no series where there is no such run.
Plot plot_speed_accuracy(const SpeedLadder& ladder, const SpeedProblem& problem, const std::string& poissons_ratio,
                         const std::vector<SpeedRun>& runs, const std::string& mode);

}  // namespace soft_robot_lab
