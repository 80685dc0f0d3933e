// SPDX-License-Identifier: BSD-3-Clause
// How exact at what cost: every rung of our ladder of methods, and Bullet's deformable solver, on bodies whose true
// deformation is known (config/experiments/speed_accuracy.yaml).
#pragma once

#include <string>
#include <vector>

#include "study/experiment.h"

namespace soft_robot_lab {

struct SpeedAccuracyOptions {
  std::vector<std::string> problems;         // names; empty: all
  std::vector<std::string> poissons_ratios;  // as the settings write them; empty: all
  std::vector<std::string> reuse;            // runs.json of earlier charts: what stands there is not measured again
  bool reuse_bullet_only = false;            // of those, only Bullet's runs
  bool quick = false;                        // a small part, to see that all works
  std::string bullet_program;                // bullet_peer; empty: without Bullet
};

// Plots: per problem and Poisson's ratio error over cost; error over element size; cost over nodes; time steps.
// Writes runs.json, with every run so far, to the output folder after each rung.
// Numbers: whether the cheapest rungs keep the promises of the README.
ExperimentResult run_speed_accuracy(const ExperimentContext& context, const SpeedAccuracyOptions& options);

}  // namespace soft_robot_lab
