#include "newton_solver.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace soft_robot_lab {
namespace {

constexpr double kPenaltyOverMu = 5.0;  // stiffness of the merit function against volume mismatch
constexpr int kHalvings = 8;

Eigen::Map<const Eigen::VectorXd> as_vector(const Eigen::Matrix3Xd& columns) { return {columns.data(), columns.size()}; }

std::vector<std::vector<int>> cliques_of(const Body& body, const std::vector<const Constraint*>& constraints) {
  std::vector<std::vector<int>> cliques;
  const auto& tets = body.mesh().tets;
  for (Eigen::Index e = 0; e < tets.cols(); ++e) cliques.emplace_back(tets.col(e).data(), tets.col(e).data() + tets.rows());
  for (const Constraint* constraint : constraints)
    for (auto& clique : constraint->coupled_nodes()) cliques.push_back(std::move(clique));
  return cliques;
}

// Solves S y = b with y between bounds, S positive definite: an active set that adds one constraint at a time (Nocedal &
// Wright 2006, 16.5, for the dual of a cable that can only pull).
Eigen::VectorXd solve_bounded(const Eigen::MatrixXd& s, const Eigen::VectorXd& b, const std::vector<ConstraintLaw>& laws) {
  const int count = static_cast<int>(b.size());
  Eigen::VectorXd y = Eigen::VectorXd::Zero(count);
  std::vector<char> held(count, 0);
  for (int i = 0; i < count; ++i) {
    if (!laws[i].prescribed()) continue;
    held[i] = 1;
    y[i] = laws[i].min_multiplier;
  }
  for (int round = 0; round < 4 * count + 4; ++round) {
    std::vector<int> open;
    for (int i = 0; i < count; ++i)
      if (!held[i]) open.push_back(i);
    const int size = static_cast<int>(open.size());
    Eigen::MatrixXd sub(size, size);
    Eigen::VectorXd right(size);
    for (int i = 0; i < size; ++i) {
      right[i] = b[open[i]];
      for (int k = 0; k < count; ++k)
        if (held[k]) right[i] -= s(open[i], k) * y[k];
      for (int j = 0; j < size; ++j) sub(i, j) = s(open[i], open[j]);
    }
    const Eigen::VectorXd solved = size > 0 ? Eigen::VectorXd(sub.ldlt().solve(right)) : right;
    int worst = -1;
    double worst_by = 0.0;
    for (int i = 0; i < size; ++i) {
      const ConstraintLaw& law = laws[open[i]];
      const double beyond = std::max(law.min_multiplier - solved[i], solved[i] - law.max_multiplier);
      y[open[i]] = std::clamp(solved[i], law.min_multiplier, law.max_multiplier);
      if (beyond > worst_by) {
        worst_by = beyond;
        worst = open[i];
      }
    }
    if (worst >= 0) {
      held[worst] = 1;
      continue;
    }
    // A held multiplier whose constraint would rather pull away from its bound is let go.
    int release = -1;
    for (int i = 0; i < count; ++i) {
      if (!held[i] || laws[i].prescribed()) continue;
      const double pull = b[i] - s.row(i).dot(y);
      const bool at_min = y[i] <= laws[i].min_multiplier;
      if ((at_min && pull > 1e-12 * std::abs(b[i])) || (!at_min && pull < -1e-12 * std::abs(b[i]))) release = i;
    }
    if (release < 0) break;
    held[release] = 0;
  }
  return y;
}

// How far a constraint is from its law at multiplier y: zero on a bound that holds it (a slack cable).
double violation(const ConstraintLaw& law, double y) {
  if (law.prescribed()) return 0.0;
  const double mismatch = law.offset - law.compliance * y;
  if (y <= law.min_multiplier) return std::max(0.0, mismatch);
  if (y >= law.max_multiplier) return std::min(0.0, mismatch);
  return mismatch;
}

}  // namespace

NewtonSolver::NewtonSolver(const Body& body, std::vector<const Constraint*> constraints)
    : body_(body),
      constraints_(std::move(constraints)),
      loads_n_(body.external_forces_n()),
      force_floor_n_(1e-9 * body.material().youngs_modulus_pa * body.size_m() * body.size_m()),
      matrix_(body.mesh().node_count(), cliques_of(body, constraints_)),
      factor_(matrix_),
      elements_(body, matrix_) {
  for (const Constraint* constraint : constraints_) adders_.emplace_back(matrix_, constraint->coupled_nodes());
}

void NewtonSolver::release(Eigen::Matrix3Xd& forces) const {
  forces = (body_.fixed().array()).select(0.0, forces.array()).matrix();
}

Eigen::MatrixXd NewtonSolver::border(const Eigen::Matrix3Xd& positions) const {
  Eigen::MatrixXd columns(positions.size(), constraint_count());
  Eigen::Matrix3Xd gradient(3, positions.cols());
  for (int i = 0; i < constraint_count(); ++i) {
    gradient.setZero();
    constraints_[i]->add_gradient(positions, 1.0, gradient);
    release(gradient);
    columns.col(i) = as_vector(gradient);
  }
  return columns;
}

NewtonSolver::Evaluation NewtonSolver::evaluate(const NewtonTask& task, const NewtonState& state) const {
  Evaluation result;
  result.residual_n = Eigen::Matrix3Xd::Zero(3, state.positions_m.cols());
  result.elements = elements_.add_gradient(state.positions_m, state.element_multipliers_pa, result.residual_n);
  double largest = std::max(force_floor_n_, std::max(result.residual_n.norm(), loads_n_.norm()));
  result.smooth_energy = result.elements.elastic_energy - loads_n_.cwiseProduct(state.positions_m).sum();
  if (task.inertia_per_s2 > 0.0) {
    const Eigen::Matrix3Xd lag = state.positions_m - *task.predicted_m;
    const Eigen::Matrix3Xd inertia = task.inertia_per_s2 * lag * body_.node_masses_kg().asDiagonal();
    result.smooth_energy += 0.5 * inertia.cwiseProduct(lag).sum();
    result.residual_n += inertia;
  }
  result.residual_n -= loads_n_;

  double constraint_residual = 0.0;
  for (int i = 0; i < constraint_count(); ++i) {
    const double y = state.constraint_multipliers[i];
    result.values.push_back(constraints_[i]->value(state.positions_m));
    result.laws.push_back(constraints_[i]->law(result.values.back()));
    if (y != 0.0) constraints_[i]->add_gradient(state.positions_m, y, result.residual_n);
    // Relative to the constraint's own value, so that lengths and volumes count alike.
    constraint_residual = std::max(constraint_residual, std::abs(violation(result.laws.back(), y)) /
                                                            std::max(std::abs(result.values.back()), 1e-300));
  }
  release(result.residual_n);
  const double volume_residual =
      elements_.mismatch(result.elements.growth, state.element_multipliers_pa).cwiseAbs().maxCoeff();
  result.relative_residual = std::max({result.residual_n.norm() / largest, constraint_residual, volume_residual});
  result.finite = std::isfinite(result.relative_residual) && std::isfinite(result.smooth_energy) &&
                  result.residual_n.allFinite();
  return result;
}

bool NewtonSolver::linearise(const NewtonTask& task, const NewtonState& state, bool convex, Eigen::Matrix3Xd& gradient) {
  matrix_.set_zero();
  gradient = Eigen::Matrix3Xd::Zero(3, state.positions_m.cols());
  elements_.add_hessian(state.positions_m, state.element_multipliers_pa, convex, matrix_, gradient);
  gradient -= loads_n_;
  if (task.inertia_per_s2 > 0.0) {
    for (Eigen::Index node = 0; node < gradient.cols(); ++node) {
      const double weight = task.inertia_per_s2 * body_.node_masses_kg()[node];
      matrix_.add_to_diagonal(static_cast<int>(node), weight);
      gradient.col(node) += weight * (state.positions_m.col(node) - task.predicted_m->col(node));
    }
  }
  for (int i = 0; i < constraint_count(); ++i)
    if (state.constraint_multipliers[i] != 0.0)
      constraints_[i]->add_hessian(state.positions_m, state.constraint_multipliers[i], adders_[i]);
  matrix_.hold(body_.fixed());
  release(gradient);
  return factor_.factorise(matrix_);
}

bool NewtonSolver::find_step(const NewtonTask& task, const NewtonState& state, const Evaluation& here, bool convex,
                             Step& step) {
  Eigen::Matrix3Xd gradient;
  if (!linearise(task, state, convex, gradient)) return false;
  const int count = constraint_count();
  const Eigen::MatrixXd b = border(state.positions_m);
  Eigen::MatrixXd solved(gradient.size(), 1 + count);
  solved.col(0) = -as_vector(gradient);
  solved.rightCols(count) = b;
  factor_.solve(solved);

  Eigen::VectorXd motion = solved.col(0);
  step.constraint_multipliers.resize(count);
  step.penalties.resize(count);
  if (count > 0) {
    Eigen::MatrixXd schur = b.transpose() * solved.rightCols(count);
    Eigen::VectorXd right = b.transpose() * motion;
    for (int i = 0; i < count; ++i) {
      step.penalties[i] = 1.0 / std::max(schur(i, i) + here.laws[i].compliance, 1e-300);
      schur(i, i) += here.laws[i].compliance;
      right[i] += here.laws[i].offset;
    }
    step.constraint_multipliers = solve_bounded(schur, right, here.laws);
    motion -= solved.rightCols(count) * step.constraint_multipliers;
  }
  if (!motion.allFinite()) return false;
  step.motion_m = Eigen::Map<const Eigen::Matrix3Xd>(motion.data(), 3, state.positions_m.cols());
  step.element_multipliers_pa = elements_.updated_multipliers(here.elements.growth, step.motion_m);

  // Slope of the merit function; -slope = dx' A dx without its volumetric part, plus the penalties' decrease.
  const Eigen::VectorXd c = elements_.mismatch(here.elements.growth, step.element_multipliers_pa);
  const double squared = c.cwiseAbs2().dot(elements_.rest_volumes_m3());
  step.slope = gradient.cwiseProduct(step.motion_m).sum() + (elements_.lambda_pa() - kPenaltyOverMu * elements_.mu_pa()) * squared;
  step.slope += step.constraint_multipliers.dot(b.transpose() * motion);
  for (int i = 0; i < count; ++i)
    step.slope -= step.penalties[i] * std::pow(violation(here.laws[i], step.constraint_multipliers[i]), 2);
  return std::isfinite(step.slope);
}

double NewtonSolver::merit(const Evaluation& at, const Step& step) const {
  // Augmented Lagrangian at the step's multipliers: the mixed problem has no energy of its own to descend, and the
  // condensed energy would refuse every step that changes volume a little on the way.
  const Eigen::VectorXd& p = step.element_multipliers_pa;
  const Eigen::VectorXd c = elements_.mismatch(at.elements.growth, p);
  double sum = at.smooth_energy;
  sum += (p.cwiseProduct(c) + 0.5 * kPenaltyOverMu * elements_.mu_pa() * c.cwiseAbs2()).dot(elements_.rest_volumes_m3());
  for (int i = 0; i < constraint_count(); ++i) {
    const double y = step.constraint_multipliers[i];
    sum += y * at.values[i] + 0.5 * step.penalties[i] * std::pow(violation(at.laws[i], y), 2);
  }
  return sum;
}

NewtonReport NewtonSolver::solve(const NewtonTask& task, NewtonState& state) {
  NewtonReport report;
  Evaluation here = evaluate(task, state);
  if (!here.finite) {
    report.reason = "the starting state is not finite";
    report.residual = 1.0;
    return report;
  }
  const auto finish = [&](std::string reason) {
    report.residual = here.relative_residual;
    report.inverted_elements = here.elements.inverted;
    report.worst_element = here.elements.worst_element;
    report.converged = reason.empty();
    report.reason = std::move(reason);
    return report;
  };

  bool convex = false;
  while (report.iterations < task.max_iterations) {
    if (report.iterations >= task.min_iterations && here.relative_residual <= task.tolerance) return finish("");
    Step step;
    ++report.iterations;
    bool found = find_step(task, state, here, convex, step);
    if (!convex && (!found || step.slope > 0.0)) {
      convex = true;
      found = find_step(task, state, here, convex, step);
    }
    if (convex) ++report.convexified;
    if (!found) return finish("the stiffness matrix could not be factorised");

    const double start = merit(here, step);
    double length = 1.0;
    bool accepted = false;
    for (int halving = 0; halving <= kHalvings && !accepted; ++halving, length *= 0.5) {
      NewtonState trial = state;
      trial.positions_m += length * step.motion_m;
      trial.element_multipliers_pa += length * (step.element_multipliers_pa - state.element_multipliers_pa);
      trial.constraint_multipliers += length * (step.constraint_multipliers - state.constraint_multipliers);
      Evaluation there = evaluate(task, trial);
      if (!there.finite) continue;
      const double allowed = start + 1e-4 * length * step.slope + 1e-12 * std::abs(start);
      accepted = merit(there, step) <= allowed || there.relative_residual < 0.5 * here.relative_residual;
      if (!accepted) continue;
      state = std::move(trial);
      here = std::move(there);
    }
    if (length < 0.5) ++report.shortened;
    if (accepted) {
      convex = convex && length < 0.5;
      continue;
    }
    if (convex) return finish("no step lowers the energy");
    convex = true;
  }
  return finish(here.relative_residual <= task.tolerance ? "" : "iteration limit");
}

Eigen::MatrixXd NewtonSolver::sensitivities(const NewtonState& state) {
  Eigen::Matrix3Xd gradient;
  if (!linearise(NewtonTask{}, state, false, gradient)) return {};
  const int count = constraint_count();
  const Eigen::MatrixXd b = border(state.positions_m);
  Eigen::MatrixXd solved = b;
  factor_.solve(solved);
  Eigen::MatrixXd schur = b.transpose() * solved;
  Eigen::MatrixXd drive = Eigen::MatrixXd::Zero(count, count);  // rows: constraints, columns: commands
  for (int i = 0; i < count; ++i) {
    const ConstraintLaw law = constraints_[i]->law(constraints_[i]->value(state.positions_m));
    const double y = state.constraint_multipliers[i];
    const bool slack = !law.prescribed() && (y <= law.min_multiplier || y >= law.max_multiplier);
    if (law.prescribed() || slack) {
      // dy is known: replace the row by dy = given.
      schur.row(i).setZero();
      schur(i, i) = 1.0;
      drive(i, i) = law.prescribed() ? law.multiplier_per_command : 0.0;
    } else {
      schur(i, i) += law.compliance;
      drive(i, i) = law.offset_per_command;
    }
  }
  if (count == 0) return solved;
  return -solved * schur.fullPivLu().solve(drive);
}

}  // namespace soft_robot_lab
