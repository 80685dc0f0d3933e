// SPDX-License-Identifier: BSD-3-Clause
#include "reduced_newton.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "mechanics/complementarity/multiplier_problem.h"

namespace soft_robot_lab {
namespace {

constexpr int kMostIterations = 60;
constexpr double kLeastShare = 1.0 / 64.0;  // of a step
constexpr double kSlow = 0.3;               // a step more than this of the last one asks for a new factor
constexpr int kMostJumps = 3;               // where skin comes to lie elsewhere, and no share of a step is nearer
constexpr int kMostRounds = 4;              // in which a step learns what skin it leads into
constexpr double kLongestStep = 0.05;       // of the body's size, rms: further out Newton's model means nothing

// Multipliers at which every constraint obeys its law after the step d0 - response * multipliers; and slips.
Multipliers multipliers_after(const ReducedConstraints::Values& constraints, const Eigen::VectorXd& step,
                              const Eigen::MatrixXd& response, const Eigen::VectorXd& multipliers) {
  MultiplierProblem problem;
  problem.delassus = constraints.gradients.transpose() * response;
  problem.excess = constraints.gradients.transpose() * step;
  problem.laws = constraints.laws;
  problem.friction_contacts = constraints.friction_contacts;
  for (Eigen::Index i = 0; i < multipliers.size(); ++i) {
    const ConstraintLaw& law = constraints.laws[static_cast<std::size_t>(i)];
    problem.delassus(i, i) += law.compliance;
    problem.excess[i] += law.offset;
  }
  return solve_multipliers(problem, multipliers);
}

// Skin that touches at the end of a motion and is not among `here`, as it would be seen from where that begins.
std::vector<ReducedSkin::Touch> met_by(const Eigen::VectorXd& motion, const std::vector<ReducedSkin::Touch>& end,
                                       const ReducedConstraints::Values& here) {
  std::vector<ReducedSkin::Touch> met;
  for (const ReducedSkin::Touch& touch : end) {
    const auto same = [&](const ReducedSkin::Touch& other) { return other.place == touch.place; };
    if (std::any_of(here.touches.begin(), here.touches.end(), same)) continue;
    met.push_back(touch);
    met.back().law.offset -= touch.gradient.dot(motion);
    met.back().found.pressure_pa = 0.0;
  }
  return met;
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
  matrix.bottomRightCorner(r, r) = -model.energy.bulk_compliance();
  return matrix;
}

Eigen::VectorXd all_multipliers(const ReducedUnknowns& at, const ReducedConstraints::Values& constraints) {
  Eigen::VectorXd all(static_cast<Eigen::Index>(constraints.laws.size()));
  all << at.multipliers, at.pushes_n(constraints.touching());
  return all;
}

Eigen::MatrixXd bordered(const Eigen::MatrixXd& inner, const ReducedConstraints::Values& constraints,
                         const Eigen::VectorXd& multipliers) {
  const Eigen::Index m = inner.rows(), n = constraints.gradients.rows(), y = multipliers.size();
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(m + y, m + y);
  matrix.topLeftCorner(m, m) = inner;
  const double stiffness = inner.topLeftCorner(n, n).norm();
  const std::vector<int> group =
      slipping_groups({{}, {}, constraints.laws, constraints.friction_contacts}, multipliers);
  for (int g = 0; g < y; ++g) {
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(n);
    double compliance = 0.0;
    bool acts = false;
    for (Eigen::Index c = 0; c < y; ++c) {
      const ConstraintLaw& law = constraints.laws[static_cast<std::size_t>(c)];
      if (group[static_cast<std::size_t>(c)] != g || !active(law, multipliers[c])) continue;
      acts = true;
      gradient += constraints.gradients.col(c);
      compliance += law.compliance;
    }
    const double scale = stiffness / std::max(gradient.norm(), 1e-300);
    if (acts) matrix.col(m + g).head(n) = matrix.row(m + g).head(n) = scale * gradient;
    matrix(m + g, m + g) = acts ? -scale * scale * compliance : -stiffness;
  }
  return matrix;
}

ReducedConstraints::Values ReducedNewton::constraints_at(const ReducedUnknowns& at, const DriveStates& drives) {
  ReducedConstraints::Values values = model_->constraints.at(at.q, at.multipliers, drives);
  values.add(skin_.at(at.q, at.pushes_n));
  return values;
}

ReducedNewton::Point ReducedNewton::point_at(const Problem& problem, ReducedUnknowns at,
                                             const std::vector<ReducedSkin::Touch>& touches) const {
  ReducedConstraints::Values constraints = model_->constraints.at(at.q, at.multipliers, problem.drives);
  constraints.add(touches);
  ReducedEnergy::Sums sums = model_->energy.sums(at.q, at.pressures);
  return {std::move(at), std::move(constraints), std::move(sums)};
}

void ReducedNewton::factorise(const Problem& problem, const Point& here, ReducedEnd& end) {
  const double inertia_per_s2 = problem.task.inertia_per_s2;
  const Eigen::Index n = here.at.q.size();
  Eigen::MatrixXd matrix = reduced_matrix(*model_, here.at, here.constraints, inertia_per_s2);
  if (inertia_per_s2 == 0.0 && !here.constraints.touches.empty())
    matrix.topLeftCorner(n, n) += skin_.hessian(here.constraints.touches);
  inverse_ = matrix.inverse();
  inverse_inertia_ = inertia_per_s2;
  fresh_ = true;
  ++end.factorisations;
}

ReducedNewton::Step ReducedNewton::step_from(const Problem& problem, const Point& here, ReducedEnd& end) const {
  if (interrupt_) interrupt_->check();
  ++end.iterations;
  const ReducedConstraints::Values& constraints = here.constraints;
  const Eigen::Index n = here.at.q.size(), r = here.at.pressures.size(), own = here.at.multipliers.size();
  const Eigen::VectorXd before = all_multipliers(here.at, constraints);
  Eigen::MatrixXd sides = Eigen::MatrixXd::Zero(n + r, 1 + before.size());
  sides.col(0).head(n) = -(here.sums.force + problem.task.inertia_per_s2 * (here.at.q - problem.task.from));
  sides.col(0).tail(r) = -here.sums.mismatch;
  sides.topRightCorner(n, before.size()) = constraints.gradients;
  Step step;
  step.size_m = std::numeric_limits<double>::infinity();
  const Eigen::MatrixXd solved = inverse_ * sides;
  if (!solved.allFinite()) return step;
  const Eigen::MatrixXd response = solved.rightCols(before.size());
  const Multipliers found = multipliers_after(constraints, solved.col(0).head(n), response.topRows(n), before);
  if (!found.found || !found.y.allFinite()) return step;
  const Eigen::VectorXd& after = found.y;
  step.nodes_and_pressures = solved.col(0) - response * after;
  step.multipliers = after.head(own) - here.at.multipliers;
  step.pushes_n = -here.at.pushes_n;
  step.pushes_n(constraints.touching()) += after.tail(after.size() - own);
  step.slips_m = -here.at.slips_m;
  if (here.at.slips_m.size() > 0) step.slips_m += found.slips_m;
  step.size_m = step.nodes_and_pressures.head(n).norm() / std::sqrt(model_->mass_kg);
  return step;
}

ReducedEnd ReducedNewton::solve(const ReducedTask& task, const DriveStates& drives, ReducedUnknowns& unknowns) {
  const Problem problem{task, drives};
  ReducedEnd end;
  unknowns.slips_m.setZero(model_->constraints.friction_contact_count());
  Point here = point_at(problem, unknowns, skin_.at(unknowns.q, unknowns.pushes_n));
  fresh_ = false;
  if (task.inertia_per_s2 != inverse_inertia_) factorise(problem, here, end);
  Step step = step_from(problem, here, end);
  int jumps = 0;
  while (end.iterations < kMostIterations && std::isfinite(step.size_m) && step.size_m >= task.tolerance_m)
    if (!go(problem, here, step, end)) {
      if (here.constraints.touches.empty() || ++jumps > kMostJumps) break;
      here = end_of(problem, longest_share(step), here, step, end);
      factorise(problem, here, end);
      step = step_from(problem, here, end);
    }
  end.converged = step.size_m < task.tolerance_m;
  unknowns = end.converged ? moved(here.at, step, 1.0) : here.at;
  if (!end.converged) inverse_inertia_ = -1.0;
  return end;
}

ReducedUnknowns ReducedNewton::moved(const ReducedUnknowns& from, const Step& step, double share) {
  return {from.q + share * step.nodes_and_pressures.head(from.q.size()),
          from.pressures + share * step.nodes_and_pressures.tail(from.pressures.size()),
          from.multipliers + share * step.multipliers, from.pushes_n + share * step.pushes_n,
          from.slips_m + share * step.slips_m};
}

double ReducedNewton::longest_share(const Step& step) const {
  return std::min(1.0, kLongestStep * model_->size_m / step.size_m);
}

ReducedNewton::Point ReducedNewton::end_of(const Problem& problem, double share, Point& here, Step& step,
                                           ReducedEnd& end) {
  for (int round = 0;; ++round) {
    ReducedUnknowns there = moved(here.at, step, share);
    const std::vector<ReducedSkin::Touch> touches = skin_.at(there.q, there.pushes_n);
    const std::vector<ReducedSkin::Touch> met = met_by(there.q - here.at.q, touches, here.constraints);
    if (met.empty() || round == kMostRounds) return point_at(problem, std::move(there), touches);
    here.constraints.add(met);
    Step heeding = step_from(problem, here, end);
    --end.iterations;  // it goes from where the last one does
    if (!std::isfinite(heeding.size_m)) return point_at(problem, std::move(there), touches);
    step = std::move(heeding);
  }
}

bool ReducedNewton::go(const Problem& problem, Point& here, Step& step, ReducedEnd& end) {
  const double longest = longest_share(step);
  for (double share = longest; share >= kLeastShare * longest && end.iterations < kMostIterations; share *= 0.5) {
    Point there = end_of(problem, share, here, step, end);
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
bool ReducedNewton::stable(const DriveStates& drives, const ReducedUnknowns& at, double inertia_per_s2) {
  const ReducedConstraints::Values constraints = constraints_at(at, drives);
  const Eigen::VectorXd multipliers = all_multipliers(at, constraints);
  const Eigen::Index n = at.q.size(), r = at.pressures.size();
  const Eigen::MatrixXd inner = reduced_matrix(*model_, at, constraints, inertia_per_s2);
  const Eigen::MatrixXd volumes = inner.topRightCorner(n, r);
  Eigen::MatrixXd stiffness =
      inner.topLeftCorner(n, n) + volumes * model_->energy.bulk_compliance().llt().solve(volumes.transpose());
  if (!constraints.touches.empty()) stiffness += skin_.hessian(constraints.touches);
  const Eigen::MatrixXd matrix = bordered(stiffness, constraints, multipliers);
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly)
             .eigenvalues()[multipliers.size()] > 0.0;
}

}  // namespace soft_robot_lab
