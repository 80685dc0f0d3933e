// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "mechanics/state/interrupt.h"
#include "reduced_model.h"

namespace soft_robot_lab {

struct ReducedUnknowns {
  Eigen::VectorXd q, pressures, multipliers;  // of modes, of elements, of constraints
  Eigen::VectorXd pushes_n;                   // of ReducedSkin
  Eigen::VectorXd slips_m = {};               // per friction contact, since the step began
};

// Inertia inertia_per_s2 / 2 |q - from|^2, on top of the energy: 1/h^2 of a time step, zero of an equilibrium.
struct ReducedTask {
  double inertia_per_s2;
  Eigen::VectorXd from;
  double tolerance_m;  // ends with a Newton step whose rms displacement is below
};

struct ReducedEnd {
  bool converged = false;
  int iterations = 0, factorisations = 0;  // linear solves, and factors for them
  int shortened = 0;                       // steps cut by the line search
};

// The matrix of all but the constraints, [K + inertia, G; G', -B]; G: ReducedEnergy::volume_gradients. How
// pushes of the skin turn with it (ReducedSkin::hessian) is not in it; time steps gain nothing by that.
Eigen::MatrixXd reduced_matrix(const ReducedModel& model, const ReducedUnknowns& at,
                               const ReducedConstraints::Values& constraints, double inertia_per_s2);

// Those of the model's constraints, and then of the skin that touches in `constraints`.
Eigen::VectorXd all_multipliers(const ReducedUnknowns& at, const ReducedConstraints::Values& constraints);

// A matrix whose first rows and columns are q's, with a row and column for each constraint below: its gradient where
// it acts, scaled to the matrix, and a negative pivot alone where it does not, as a slack cable. Constraints between
// which length slips act as one (slipping_groups).
Eigen::MatrixXd bordered(const Eigen::MatrixXd& inner, const ReducedConstraints::Values& constraints,
                         const Eigen::VectorXd& multipliers);

// Newton's method on q, pressures and multipliers together; the constraints are a border (MultiplierProblem), cables
// with friction too. A step is cut until the next one by the same inverse is shorter (natural monotonicity test,
// Deuflhard 2004, 3.3). An inverse serves, also in further solves, as long as each step is less than 0.3 of the one
// before. What a step would lead into of skin is learnt before it is taken. Where no share of a step passes, as skin
// comes to lie on another face, the step is taken all the same, a few times.
class ReducedNewton {
 public:
  explicit ReducedNewton(const ReducedModel& model) : model_(&model), skin_(model.skin) {}  // which outlives it

  // As NewtonSolver has it.
  void heed(const Interrupt* interrupt) { interrupt_ = interrupt; }

  // Changes `unknowns` in any case.
  ReducedEnd solve(const ReducedTask& task, const DriveStates& drives, ReducedUnknowns& unknowns);

  // Whether the constraints hold q in a minimum of the energy with this inertia, and not on a saddle.
  bool stable(const DriveStates& drives, const ReducedUnknowns& at, double inertia_per_s2 = 0.0);

  ReducedConstraints::Values constraints_at(const ReducedUnknowns& at, const DriveStates& drives);

 private:
  struct Problem {
    const ReducedTask& task;
    const DriveStates& drives;
  };
  struct Point {
    ReducedUnknowns at;
    ReducedConstraints::Values constraints;
    ReducedEnergy::Sums sums;
  };
  struct Step {
    Eigen::VectorXd nodes_and_pressures, multipliers, pushes_n, slips_m;  // changes
    double size_m = 0.0;                                                  // rms; infinity: none found
  };
  Point point_at(const Problem& problem, ReducedUnknowns at, const std::vector<ReducedSkin::Touch>& touches) const;
  void factorise(const Problem& problem, const Point& here, ReducedEnd& end);
  Step step_from(const Problem& problem, const Point& here, ReducedEnd& end) const;
  static ReducedUnknowns moved(const ReducedUnknowns& from, const Step& step, double share);
  double longest_share(const Step& step) const;
  // Where a share of the step leads. The step heeds the skin that it leads into: in rounds, as it leads elsewhere then.
  Point end_of(const Problem& problem, double share, Point& here, Step& step, ReducedEnd& end);
  // Goes along the step, which becomes the next one; false where no share of it passes.
  bool go(const Problem& problem, Point& here, Step& step, ReducedEnd& end);

  const ReducedModel* model_;
  const Interrupt* interrupt_ = nullptr;
  ReducedSkin skin_;
  Eigen::MatrixXd inverse_;
  double inverse_inertia_ = -1.0;  // none yet
  bool fresh_ = false;             // the inverse is of the present point
};

}  // namespace soft_robot_lab
