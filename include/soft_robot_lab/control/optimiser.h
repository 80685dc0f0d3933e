// SPDX-License-Identifier: BSD-3-Clause
// Solves a reach problem (control/reach_problem.h) by one of several methods.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "reach_problem.h"

namespace soft_robot_lab {

// gauss_newton           exact derivatives, second order by secants, bounds (default)
// rmsprop, pid           as published (7.3, and 7.12 to 7.16), for comparison; pid swings where its loop gain
//                        150 |J|^2 exceeds 1, and rests short of the target elsewhere
// pid_projected          PID on the error projected by the model's Jacobian: the one to use
// cma_es, differential_evolution   populations, for objectives with many minima
const std::vector<std::string>& optimiser_methods();

struct OptimiserOptions {
  std::string method = "gauss_newton";
  // 0: the method's own (gauss_newton 60, rmsprop and pid_projected 1000, pid 100, populations 50 generations).
  int max_iterations = 0;
  // The target counts as reached within it; gauss_newton stops when a step gains less than a tenth of it.
  double tolerance_m = 1.0e-5;
  // Of rmsprop: it stops where each command's derivative of the objective is smaller. 0: never.
  double gradient_tolerance_m2 = 0.0;
  int population = 12;    // [5, 1000], of the methods that have one
  unsigned int seed = 1;  // of their random numbers
  void validate() const;
};

struct OptimisationProgress {
  int iteration = 0;
  double distance_m = 0.0;
  Eigen::VectorXd commands;
};
// Called after each iteration; returning false cancels.
using ProgressCallback = std::function<bool(const OptimisationProgress&)>;

struct OptimisationSummary {
  bool usable = false;         // commands are within the bounds and no worse than the start
  std::string stop_reason;     // "converged", "iteration limit", "cancelled", or what failed
  Eigen::VectorXd commands;    // the best found
  Eigen::Matrix3Xd markers_m;  // where they rest then, one column per goal: where it converged, the nearest that is in
                               // reach of the start
  double initial_distance_m = 0.0;  // of several goals the weighted root mean square
  double final_distance_m = 0.0;
  int iterations = 0;
  int evaluations = 0;  // equilibria asked for
  double cpu_s = 0.0;
  double wall_s = 0.0;
  std::vector<std::string> active_limits;  // "left at its minimum 0.7", "left near its largest tension 8 N"
  bool target_reached = false;             // final distance below the tolerance
};

// Throws std::invalid_argument for a bad problem or option; a failing model ends the search and is named in
// stop_reason.
OptimisationSummary optimise(const ReachProblem& problem, const OptimiserOptions& options,
                             const ProgressCallback& progress = {});

}  // namespace soft_robot_lab
