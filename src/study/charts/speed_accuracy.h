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
  std::vector<std::string> parts;            // of speed_parts(); empty: all
  std::vector<std::string> reuse;            // runs.json of earlier charts: what stands there is not measured again
  bool reuse_bullet_only = false;            // of those, only Bullet's runs
  bool quick = false;                        // a small part, to see that all works
  std::string bullet_program;                // bullet_peer; empty: without Bullet
};

// errors: of every problem, by every method; convergence: over elements and time steps; nodes: cost over nodes; motion:
// a robot by every method and reduced models; rollouts: how many a core does.
std::vector<std::string> speed_parts();

// Plots: per problem and Poisson's ratio error over cost; error over element size; cost over nodes; time steps; a robot
// in motion; rollouts; and all beside what others published. Writes runs.json, with every run so far, to the output
// folder after each rung. Throws std::invalid_argument for an unknown problem or part.
// Numbers: whether the cheapest rungs keep the promises of the README.
ExperimentResult run_speed_accuracy(const ExperimentContext& context, const SpeedAccuracyOptions& options);

}  // namespace soft_robot_lab
