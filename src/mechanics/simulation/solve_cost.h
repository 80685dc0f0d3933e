// SPDX-License-Identifier: BSD-3-Clause
// What solves by newton cost, by counting: the same on every machine and under any load.
#pragma once

#include "soft_robot_lab/mechanics/model.h"
#include "soft_robot_lab/mechanics/solve_report.h"

namespace soft_robot_lab {

// CPU of one iteration, and what a new matrix adds, by the constants in solve_cost.cpp. Contact's own pairs and wider
// matrix are not in it.
struct SolveCost {
  double iteration_s = 0.0, factorisation_s = 0.0;

  double of(const SolveReport& report) const {
    return report.iterations * iteration_s + report.factorisations * factorisation_s;
  }
};

SolveCost solve_cost(const Model& model);

}  // namespace soft_robot_lab
