// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

#include "reduced_model.h"

namespace soft_robot_lab {

struct ReducedUnknowns {
  Eigen::VectorXd q, pressures, tensions_n;
};

// Inertia inertia_per_s2 / 2 |q - from|^2, on top of the energy: 1/h^2 of a time step, zero of an equilibrium.
struct ReducedTask {
  double inertia_per_s2;
  Eigen::VectorXd from;
  double tolerance_m;  // ends with a Newton step whose rms displacement is below
};

struct ReducedEnd {
  bool converged = false;
  int iterations = 0, factorisations = 0;
};

// The matrix of all but the cables, [K + inertia, G; G', -1/lambda].
Eigen::MatrixXd reduced_matrix(const ReducedModel& model, const ReducedUnknowns& at,
                               const ReducedCables::Values& cables, double inertia_per_s2);

// Newton's method on q, pressures and tensions together; the cables are a border (MultiplierProblem). A factor serves
// as long as each step is less than 0.3 of the one before.
class ReducedNewton {
 public:
  // Changes `unknowns` in any case.
  ReducedEnd solve(const ReducedModel& model, const ReducedTask& task, const DriveStates& drives,
                   ReducedUnknowns& unknowns);

 private:
  bool iterate(const ReducedModel& model, const ReducedTask& task, const DriveStates& drives, ReducedUnknowns& unknowns,
               ReducedEnd& end);

  Eigen::PartialPivLU<Eigen::MatrixXd> factor_;
  double factor_inertia_ = -1.0;  // none yet
  double step_m_ = 0.0;           // of the last iteration
};

// Whether the cables and constraints hold q in a minimum of the energy, and not on a saddle.
bool stable(const ReducedModel& model, const DriveStates& drives, const ReducedUnknowns& at);

}  // namespace soft_robot_lab
