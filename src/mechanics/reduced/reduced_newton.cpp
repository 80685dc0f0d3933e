// SPDX-License-Identifier: BSD-3-Clause
#include "reduced_newton.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "mechanics/newton/multiplier_problem.h"

namespace soft_robot_lab {
namespace {

constexpr int kMostIterations = 60;
constexpr double kLeastShare = 1.0 / 64.0;  // of a step
constexpr double kSlow = 0.3;               // a step more than this of the last one asks for a new factor
constexpr double kLongestStep = 0.05;       // of the body's size, rms: further out Newton's model means nothing

// Multipliers at which every constraint obeys its law after the step d0 - response * multipliers.
Eigen::VectorXd multipliers_after(const ReducedConstraints::Values& constraints, const Eigen::VectorXd& step,
                                  const Eigen::MatrixXd& response, const Eigen::VectorXd& multipliers) {
  MultiplierProblem problem;
  problem.delassus = constraints.gradients.transpose() * response;
  problem.excess = constraints.gradients.transpose() * step;
  problem.laws = constraints.laws;
  for (Eigen::Index i = 0; i < multipliers.size(); ++i) {
    const ConstraintLaw& law = constraints.laws[static_cast<std::size_t>(i)];
    problem.delassus(i, i) += law.compliance;
    problem.excess[i] += law.offset;
  }
  const Multipliers found = solve_multipliers(problem, multipliers);
  return found.found ? found.y : Eigen::VectorXd();
}

ReducedUnknowns moved(const ReducedUnknowns& from, const Eigen::VectorXd& step, const Eigen::VectorXd& multipliers,
                      double share) {
  return {from.q + share * step.head(from.q.size()), from.pressures + share * step.tail(from.pressures.size()),
          from.multipliers + share * multipliers};
}

}  // namespace

Eigen::MatrixXd reduced_matrix(const ReducedModel& model, const ReducedUnknowns& at,
                               const ReducedConstraints::Values& constraints, double inertia_per_s2) {
  const Eigen::Index n = at.q.size(), r = at.pressures.size();
  Eigen::MatrixXd matrix(n + r, n + r);
  matrix.topLeftCorner(n, n) =
      model.energy.hessian(at.q, at.pressures) + model.constraints.hessian(at.q, constraints, at.multipliers);
  matrix.topLeftCorner(n, n).diagonal().array() += inertia_per_s2;
  matrix.topRightCorner(n, r) = model.energy.volume_gradients(at.q);
  matrix.bottomLeftCorner(r, n) = matrix.topRightCorner(n, r).transpose();
  matrix.bottomRightCorner(r, r) = Eigen::MatrixXd::Identity(r, r) / -model.energy.lambda_pa();
  return matrix;
}

Eigen::MatrixXd bordered(const Eigen::MatrixXd& inner, const ReducedConstraints::Values& constraints,
                         const Eigen::VectorXd& multipliers) {
  const Eigen::Index m = inner.rows(), n = constraints.gradients.rows(), y = multipliers.size();
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(m + y, m + y);
  matrix.topLeftCorner(m, m) = inner;
  const double stiffness = inner.topLeftCorner(n, n).norm();
  for (Eigen::Index c = 0; c < y; ++c) {
    const ConstraintLaw& law = constraints.laws[static_cast<std::size_t>(c)];
    const bool acts = active(law, multipliers[c]);
    const double scale = stiffness / std::max(constraints.gradients.col(c).norm(), 1e-300);
    if (acts) matrix.col(m + c).head(n) = matrix.row(m + c).head(n) = scale * constraints.gradients.col(c);
    matrix(m + c, m + c) = acts ? -scale * scale * law.compliance : -stiffness;
  }
  return matrix;
}

ReducedNewton::Point ReducedNewton::point_at(const Problem& problem, ReducedUnknowns at) {
  ReducedConstraints::Values constraints = problem.model.constraints.at(at.q, at.multipliers, problem.drives);
  ReducedEnergy::Sums sums = problem.model.energy.sums(at.q, at.pressures);
  return {std::move(at), std::move(constraints), std::move(sums)};
}

void ReducedNewton::factorise(const Problem& problem, const Point& here, ReducedEnd& end) {
  const double inertia_per_s2 = problem.task.inertia_per_s2;
  inverse_ = reduced_matrix(problem.model, here.at, here.constraints, inertia_per_s2).inverse();
  inverse_inertia_ = inertia_per_s2;
  fresh_ = true;
  ++end.factorisations;
}

ReducedNewton::Step ReducedNewton::step_from(const Problem& problem, const Point& here, ReducedEnd& end) const {
  ++end.iterations;
  const Eigen::Index n = here.at.q.size(), r = here.at.pressures.size(), y = here.at.multipliers.size();
  Eigen::MatrixXd sides = Eigen::MatrixXd::Zero(n + r, 1 + y);
  sides.col(0).head(n) = -(here.sums.force + problem.task.inertia_per_s2 * (here.at.q - problem.task.from));
  sides.col(0).tail(r) = -here.sums.mismatch;
  sides.topRightCorner(n, y) = here.constraints.gradients;
  Step step;
  step.size_m = std::numeric_limits<double>::infinity();
  const Eigen::MatrixXd solved = inverse_ * sides;
  if (!solved.allFinite()) return step;
  const Eigen::MatrixXd response = solved.rightCols(y);
  const Eigen::VectorXd after =
      multipliers_after(here.constraints, solved.col(0).head(n), response.topRows(n), here.at.multipliers);
  if (after.size() != y || !after.allFinite()) return step;
  step.nodes_and_pressures = solved.col(0) - response * after;
  step.multipliers = after - here.at.multipliers;
  step.size_m = step.nodes_and_pressures.head(n).norm() / std::sqrt(problem.model.mass_kg);
  return step;
}

ReducedEnd ReducedNewton::solve(const ReducedModel& model, const ReducedTask& task, const DriveStates& drives,
                                ReducedUnknowns& unknowns) {
  const Problem problem{model, task, drives};
  ReducedEnd end;
  Point here = point_at(problem, unknowns);
  fresh_ = false;
  if (task.inertia_per_s2 != inverse_inertia_) factorise(problem, here, end);
  Step step = step_from(problem, here, end);
  while (end.iterations < kMostIterations && std::isfinite(step.size_m) && step.size_m >= task.tolerance_m)
    if (!go(problem, here, step, end)) break;
  end.converged = step.size_m < task.tolerance_m;
  unknowns = end.converged ? moved(here.at, step.nodes_and_pressures, step.multipliers, 1.0) : here.at;
  if (!end.converged) inverse_inertia_ = -1.0;
  return end;
}

bool ReducedNewton::go(const Problem& problem, Point& here, Step& step, ReducedEnd& end) {
  const double longest = std::min(1.0, kLongestStep * problem.model.full->body().size_m() / step.size_m);
  for (double share = longest; share >= kLeastShare * longest && end.iterations < kMostIterations; share *= 0.5) {
    Point there = point_at(problem, moved(here.at, step.nodes_and_pressures, step.multipliers, share));
    Step next = step_from(problem, there, end);
    if (next.size_m <= (1.0 - 0.25 * share) * step.size_m) {
      const bool slow = next.size_m > kSlow * step.size_m && next.size_m >= problem.task.tolerance_m;
      here = std::move(there);
      step = std::move(next);
      fresh_ = false;
      if (!slow) return true;
      factorise(problem, here, end);
      step = step_from(problem, here, end);
      return true;
    }
    ++end.shortened;
    if (fresh_) continue;
    factorise(problem, here, end);
    step = step_from(problem, here, end);
    return true;
  }
  return false;
}

// By the inertia of the bordered matrix (Haynsworth 1968): a negative eigenvalue per constraint, and no more.
bool stable(const ReducedModel& model, const DriveStates& drives, const ReducedUnknowns& at, double inertia_per_s2) {
  const ReducedConstraints::Values constraints = model.constraints.at(at.q, at.multipliers, drives);
  const Eigen::Index n = at.q.size(), r = at.pressures.size(), y = at.multipliers.size();
  const Eigen::MatrixXd inner = reduced_matrix(model, at, constraints, inertia_per_s2);
  const Eigen::MatrixXd volumes = inner.topRightCorner(n, r);
  const Eigen::MatrixXd stiffness =
      inner.topLeftCorner(n, n) + model.energy.lambda_pa() * volumes * volumes.transpose();
  const Eigen::MatrixXd matrix = bordered(stiffness, constraints, at.multipliers);
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly).eigenvalues()[y] > 0.0;
}

}  // namespace soft_robot_lab
