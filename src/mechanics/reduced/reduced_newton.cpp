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

// Tensions at which every cable obeys its law after the step d0 - response * tensions.
Eigen::VectorXd tensions_after(const ReducedCables::Values& cables, const Eigen::VectorXd& step,
                               const Eigen::MatrixXd& response, const Eigen::VectorXd& tensions_n) {
  MultiplierProblem problem;
  problem.delassus = cables.gradients.transpose() * response;
  problem.excess = cables.gradients.transpose() * step;
  problem.laws = cables.laws;
  for (Eigen::Index i = 0; i < tensions_n.size(); ++i) {
    const ConstraintLaw& law = cables.laws[static_cast<std::size_t>(i)];
    problem.delassus(i, i) += law.compliance;
    problem.excess[i] += law.offset;
  }
  const Multipliers found = solve_multipliers(problem, tensions_n);
  return found.found ? found.y : Eigen::VectorXd();
}

ReducedUnknowns moved(const ReducedUnknowns& from, const Eigen::VectorXd& step, const Eigen::VectorXd& tensions_n,
                      double share) {
  return {from.q + share * step.head(from.q.size()), from.pressures + share * step.tail(from.pressures.size()),
          from.tensions_n + share * tensions_n};
}

}  // namespace

Eigen::MatrixXd reduced_matrix(const ReducedModel& model, const ReducedUnknowns& at,
                               const ReducedCables::Values& cables, double inertia_per_s2) {
  const Eigen::Index n = at.q.size(), r = at.pressures.size();
  Eigen::MatrixXd matrix(n + r, n + r);
  matrix.topLeftCorner(n, n) = model.energy.hessian(at.q, at.pressures) + model.cables.hessian(cables, at.tensions_n);
  matrix.topLeftCorner(n, n).diagonal().array() += inertia_per_s2;
  matrix.topRightCorner(n, r) = model.energy.volume_gradients(at.q);
  matrix.bottomLeftCorner(r, n) = matrix.topRightCorner(n, r).transpose();
  matrix.bottomRightCorner(r, r) = Eigen::MatrixXd::Identity(r, r) / -model.energy.lambda_pa();
  return matrix;
}

Eigen::MatrixXd bordered(const Eigen::MatrixXd& inner, const ReducedCables::Values& cables,
                         const Eigen::VectorXd& tensions_n) {
  const Eigen::Index m = inner.rows(), n = cables.gradients.rows(), y = tensions_n.size();
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(m + y, m + y);
  matrix.topLeftCorner(m, m) = inner;
  const double stiffness = inner.topLeftCorner(n, n).norm();
  for (Eigen::Index c = 0; c < y; ++c) {
    const ConstraintLaw& law = cables.laws[static_cast<std::size_t>(c)];
    const bool taut = active(law, tensions_n[c]);
    const double scale = stiffness / std::max(cables.gradients.col(c).norm(), 1e-300);
    if (taut) matrix.col(m + c).head(n) = matrix.row(m + c).head(n) = scale * cables.gradients.col(c);
    matrix(m + c, m + c) = taut ? -scale * scale * law.compliance : -stiffness;
  }
  return matrix;
}

ReducedNewton::Point ReducedNewton::point_at(const Problem& problem, ReducedUnknowns at) {
  ReducedCables::Values cables = problem.model.cables.at(at.q, at.tensions_n, problem.drives);
  ReducedEnergy::Sums sums = problem.model.energy.sums(at.q, at.pressures);
  return {std::move(at), std::move(cables), std::move(sums)};
}

void ReducedNewton::factorise(const Problem& problem, const Point& here, ReducedEnd& end) {
  const double inertia_per_s2 = problem.task.inertia_per_s2;
  inverse_ = reduced_matrix(problem.model, here.at, here.cables, inertia_per_s2).inverse();
  inverse_inertia_ = inertia_per_s2;
  fresh_ = true;
  ++end.factorisations;
}

ReducedNewton::Step ReducedNewton::step_from(const Problem& problem, const Point& here, ReducedEnd& end) const {
  ++end.iterations;
  const Eigen::Index n = here.at.q.size(), r = here.at.pressures.size(), y = here.at.tensions_n.size();
  Eigen::MatrixXd sides = Eigen::MatrixXd::Zero(n + r, 1 + y);
  sides.col(0).head(n) = -(here.sums.force + problem.task.inertia_per_s2 * (here.at.q - problem.task.from));
  sides.col(0).tail(r) = -here.sums.mismatch;
  sides.topRightCorner(n, y) = here.cables.gradients;
  Step step;
  step.size_m = std::numeric_limits<double>::infinity();
  const Eigen::MatrixXd solved = inverse_ * sides;
  if (!solved.allFinite()) return step;
  const Eigen::MatrixXd response = solved.rightCols(y);
  const Eigen::VectorXd tensions =
      tensions_after(here.cables, solved.col(0).head(n), response.topRows(n), here.at.tensions_n);
  if (tensions.size() != y || !tensions.allFinite()) return step;
  step.nodes_and_pressures = solved.col(0) - response * tensions;
  step.tensions_n = tensions - here.at.tensions_n;
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
  unknowns = end.converged ? moved(here.at, step.nodes_and_pressures, step.tensions_n, 1.0) : here.at;
  if (!end.converged) inverse_inertia_ = -1.0;
  return end;
}

bool ReducedNewton::go(const Problem& problem, Point& here, Step& step, ReducedEnd& end) {
  const double longest = std::min(1.0, kLongestStep * problem.model.full->body().size_m() / step.size_m);
  for (double share = longest; share >= kLeastShare * longest && end.iterations < kMostIterations; share *= 0.5) {
    Point there = point_at(problem, moved(here.at, step.nodes_and_pressures, step.tensions_n, share));
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

// By the inertia of the bordered matrix (Haynsworth 1968): a negative eigenvalue per active cable, and no more.
bool stable(const ReducedModel& model, const DriveStates& drives, const ReducedUnknowns& at, double inertia_per_s2) {
  const ReducedCables::Values cables = model.cables.at(at.q, at.tensions_n, drives);
  const Eigen::Index n = at.q.size(), r = at.pressures.size(), y = at.tensions_n.size();
  const Eigen::MatrixXd inner = reduced_matrix(model, at, cables, inertia_per_s2);
  const Eigen::MatrixXd volumes = inner.topRightCorner(n, r);
  const Eigen::MatrixXd stiffness =
      inner.topLeftCorner(n, n) + model.energy.lambda_pa() * volumes * volumes.transpose();
  const Eigen::MatrixXd matrix = bordered(stiffness, cables, at.tensions_n);
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly).eigenvalues()[y] > 0.0;
}

}  // namespace soft_robot_lab
