// How exact at what cost: every rung of our ladder of methods, and Bullet's deformable solver, on bodies whose true
// deformation is known (config/experiments/speed_accuracy.yaml).
#pragma once

#include <string>
#include <vector>

#include "soft_robot_lab/experiment/experiment.h"

namespace soft_robot_lab {

struct SpeedAccuracyOptions {
  std::vector<std::string> problems;  // names; empty: all
  bool quick = false;                 // a small part, to see that all works
  std::string bullet_program;         // bullet_peer; empty: without Bullet
};

// Plots: per problem and Poisson's ratio error over cost; error over element size; cost over nodes; time steps.
// Numbers: whether the cheapest rungs keep the promises of the README.
ExperimentResult run_speed_accuracy(const ExperimentContext& context, const SpeedAccuracyOptions& options);

}  // namespace soft_robot_lab
