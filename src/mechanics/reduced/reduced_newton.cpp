// SPDX-License-Identifier: BSD-3-Clause
#include "reduced_newton.h"

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "mechanics/newton/multiplier_problem.h"

namespace soft_robot_lab {
namespace {

constexpr int kMostIterations = 40;
constexpr double kSlow = 0.3;          // a step more than this of the last one asks for a new factor
constexpr double kLongestStep = 0.05;  // of the body's size, rms: further out Newton's model means nothing

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

}  // namespace

Eigen::MatrixXd reduced_matrix(const ReducedModel& model, const ReducedUnknowns& at,
                               const ReducedCables::Values& cables, double inertia_per_s2) {
  const Eigen::Index n = at.q.size(), r = at.pressures.size();
  const Eigen::MatrixXd volume_gradients = model.energy.sums(at.q, at.pressures).volume_gradients;
  Eigen::MatrixXd matrix(n + r, n + r);
  matrix.topLeftCorner(n, n) = model.energy.hessian(at.q, at.pressures) + model.cables.hessian(cables, at.tensions_n);
  matrix.topLeftCorner(n, n).diagonal().array() += inertia_per_s2;
  matrix.topRightCorner(n, r) = volume_gradients;
  matrix.bottomLeftCorner(r, n) = volume_gradients.transpose();
  matrix.bottomRightCorner(r, r) = Eigen::MatrixXd::Identity(r, r) / -model.energy.lambda_pa();
  return matrix;
}

ReducedEnd ReducedNewton::solve(const ReducedModel& model, const ReducedTask& task, const DriveStates& drives,
                                ReducedUnknowns& unknowns) {
  ReducedEnd end;
  if (task.inertia_per_s2 != factor_inertia_) factor_inertia_ = -1.0;
  step_m_ = std::numeric_limits<double>::infinity();
  while (end.iterations < kMostIterations && !end.converged)
    if (!iterate(model, task, drives, unknowns, end)) break;
  if (!end.converged) factor_inertia_ = -1.0;
  return end;
}

bool ReducedNewton::iterate(const ReducedModel& model, const ReducedTask& task, const DriveStates& drives,
                            ReducedUnknowns& unknowns, ReducedEnd& end) {
  const Eigen::Index n = unknowns.q.size(), r = unknowns.pressures.size();
  const ReducedCables::Values cables = model.cables.at(unknowns.q, unknowns.tensions_n, drives);
  if (factor_inertia_ < 0.0) {
    factor_.compute(reduced_matrix(model, unknowns, cables, task.inertia_per_s2));
    factor_inertia_ = task.inertia_per_s2;
    ++end.factorisations;
  }
  ++end.iterations;
  const ReducedEnergy::Sums sums = model.energy.sums(unknowns.q, unknowns.pressures);
  Eigen::MatrixXd sides = Eigen::MatrixXd::Zero(n + r, 1 + cables.gradients.cols());
  sides.col(0).head(n) = -(sums.force + task.inertia_per_s2 * (unknowns.q - task.from));
  sides.col(0).tail(r) = -sums.mismatch;
  sides.topRightCorner(n, cables.gradients.cols()) = cables.gradients;
  const Eigen::MatrixXd solved = factor_.solve(sides);
  const Eigen::MatrixXd response = solved.rightCols(cables.gradients.cols());
  const Eigen::VectorXd tensions =
      tensions_after(cables, solved.col(0).head(n), response.topRows(n), unknowns.tensions_n);
  if (tensions.size() != unknowns.tensions_n.size()) return false;
  const Eigen::VectorXd step = solved.col(0) - response * tensions;
  const double step_m = step.head(n).norm() / std::sqrt(model.mass_kg);
  if (!std::isfinite(step_m) || !tensions.allFinite()) return false;
  const double share = std::min(1.0, kLongestStep * model.full->body().size_m() / step_m);
  unknowns.q += share * step.head(n);
  unknowns.pressures += share * step.tail(r);
  unknowns.tensions_n += share * (tensions - unknowns.tensions_n);
  end.converged = step_m < task.tolerance_m;
  if (step_m > kSlow * step_m_ || end.iterations == 1) factor_inertia_ = end.converged ? factor_inertia_ : -1.0;
  step_m_ = step_m;
  return true;
}

bool stable(const ReducedModel& model, const DriveStates& drives, const ReducedUnknowns& at) {
  const ReducedCables::Values cables = model.cables.at(at.q, at.tensions_n, drives);
  const Eigen::Index n = at.q.size(), r = at.pressures.size();
  const Eigen::MatrixXd matrix = reduced_matrix(model, at, cables, 0.0);
  const Eigen::MatrixXd volumes = matrix.topRightCorner(n, r);
  Eigen::MatrixXd stiffness = matrix.topLeftCorner(n, n) + model.energy.lambda_pa() * volumes * volumes.transpose();
  const double stiff = 1e3 * stiffness.norm();
  for (Eigen::Index c = 0; c < at.tensions_n.size(); ++c) {
    const ConstraintLaw& law = cables.laws[static_cast<std::size_t>(c)];
    const Eigen::VectorXd gradient = cables.gradients.col(c);
    if (active(law, at.tensions_n[c]))
      stiffness += gradient * gradient.transpose() / std::max(law.compliance, gradient.squaredNorm() / stiff);
  }
  return stiffness.llt().info() == Eigen::Success;
}

}  // namespace soft_robot_lab
