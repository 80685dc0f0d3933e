// SPDX-License-Identifier: BSD-3-Clause
// Reference R6: how well a release without damping is followed, over integrator and time step.
#pragma once

#include <string>
#include <vector>

#include "speed_ladder.h"
#include "session/report/plot.h"

namespace soft_robot_lab {

struct ReleaseRun {
  std::string rung;
  double step_s = 0.0;
  double error = 0.0;          // largest distance of the tip's height from the reference's, over the first minimum
  double minimum_error = 0.0;  // of the first minimum, relative
  double period_error = 0.0;   // of the time of the first return to the top, relative
  double cost = 0.0;           // CPU-seconds per simulated second
  bool converged = true;
};

std::vector<ReleaseRun> run_releases(const ExperimentContext& context, const ReleaseProblem& release);

Plot plot_releases(const std::vector<ReleaseRun>& runs);

}  // namespace soft_robot_lab
