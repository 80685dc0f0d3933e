// SPDX-License-Identifier: BSD-3-Clause
// How fast errors fall: with elements cut into eight again and again, and with time steps halved.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "speed_ladder.h"

namespace soft_robot_lab {

// One line of a picture.
struct ConvergenceSeries {
  std::string picture;         // smooth, cantilever, time
  std::string label;           // element and Poisson's ratio, or integrator
  std::vector<double> size;    // element size [m] or time step [s], halved from one to the next
  std::vector<double> error;   // relative
  std::vector<double> orders;  // between neighbours: error ~ size^order
  bool converged = true;       // every solve
};

// A smooth problem with a known solution (manufactured_problem.h), the cantilever of reference R1, whose clamped edges
// are singular, and a swing of that cantilever. `quick`: without the finest ones.
std::vector<ConvergenceSeries> run_convergence(const ExperimentContext& context, const SpeedLadder& ladder, bool quick);

std::vector<Plot> plot_convergence(const std::vector<ConvergenceSeries>& all);
nlohmann::ordered_json convergence_json(const std::vector<ConvergenceSeries>& all);

}  // namespace soft_robot_lab
