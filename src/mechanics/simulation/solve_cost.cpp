// SPDX-License-Identifier: BSD-3-Clause
#include "solve_cost.h"

#include "workspace.h"

namespace soft_robot_lab {
namespace {

// Set by hand after times of rest states of robots of record with 200 to 5000 nodes, on one core of a machine with
// other work. How well counts and times agree was not measured.
constexpr double kFlop_s = 0.45e-10;        // of a factorisation
constexpr double kFactorNumber_s = 0.9e-9;  // of a solve, per double of the factor
constexpr double kElement_s = 1.4e-6;       // of forces, per element
constexpr double kElementMatrix_s = 2.3e-6;

}  // namespace

SolveCost solve_cost(const Model& model) {
  const NewtonTables& tables = *model.tables().newton;
  const auto elements = static_cast<double>(model.body().mesh().tet_count());
  const auto numbers = static_cast<double>(tables.factor->factor_size());
  SolveCost cost;
  cost.iteration_s = kElement_s * elements + kFactorNumber_s * numbers;
  cost.factorisation_s = kElementMatrix_s * elements + kFlop_s * tables.factor->flops() +
                         kFactorNumber_s * numbers * tables.constraint_count();
  return cost;
}

}  // namespace soft_robot_lab
