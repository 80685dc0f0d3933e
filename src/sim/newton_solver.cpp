#include "newton_solver.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace soft_robot_lab {
namespace {

constexpr double kPenaltyOverMu = 5.0;  // stiffness of the merit function against volume mismatch
constexpr int kHalvings = 8;
constexpr double kWorthwhileDecrease = 0.5;  // of the residual, by a step with an old factor
constexpr double kTieStiffness = 1e3;        // of a carried point, over E * size

Eigen::Map<const Eigen::VectorXd> as_vector(const Eigen::Matrix3Xd& columns) {
  return {columns.data(), columns.size()};
}

// Solves S y = b with y between bounds, S positive definite: an active set that adds one constraint at a time (Nocedal
// & Wright 2006, 16.5, for the dual of a cable that can only pull).
Eigen::VectorXd solve_bounded(const Eigen::MatrixXd& s, const Eigen::VectorXd& b,
                              const std::vector<ConstraintLaw>& laws) {
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

// Whether the law, and no bound, decides the multiplier y.
bool active(const ConstraintLaw& law, double y) { return y > law.min_multiplier && y < law.max_multiplier; }

// How far a constraint is from its law at multiplier y: zero on a bound that holds it (a slack cable).
double violation(const ConstraintLaw& law, double y) {
  if (law.prescribed()) return 0.0;
  const double mismatch = law.offset - law.compliance * y;
  if (y <= law.min_multiplier) return std::max(0.0, mismatch);
  if (y >= law.max_multiplier) return std::min(0.0, mismatch);
  return mismatch;
}

}  // namespace

NewtonSolver::Layout NewtonSolver::lay_out(const Body& body, const std::vector<const Constraint*>& constraints) {
  Layout layout;
  layout.node_count = body.mesh().node_count();
  for (const Constraint* constraint : constraints) {
    const int first_point = layout.node_count + layout.point_count;
    for (const EmbeddedPoint& point : constraint->carried_points()) {
      layout.ties.push_back(point.nodes);
      layout.tie_coefficients.push_back(point.weights);
      layout.ties.back().push_back(layout.node_count + layout.point_count++);
      layout.tie_coefficients.back().push_back(-1.0);
    }
    layout.cliques.emplace_back();
    for (Clique clique : constraint->cliques()) {
      for (int& member : clique)
        if (member < 0) member = first_point + ~member;
      layout.cliques.back().push_back(std::move(clique));
    }
  }
  return layout;
}

std::vector<std::vector<int>> NewtonSolver::Layout::all_cliques(const TetMesh& mesh) const {
  std::vector<std::vector<int>> all = ties;
  for (Eigen::Index e = 0; e < mesh.tets.cols(); ++e)
    all.emplace_back(mesh.tets.col(e).data(), mesh.tets.col(e).data() + mesh.tets.rows());
  for (const auto& of_constraint : cliques) all.insert(all.end(), of_constraint.begin(), of_constraint.end());
  return all;
}

NewtonSolver::NewtonSolver(const Body& body, std::vector<const Constraint*> constraints)
    : body_(body),
      constraints_(std::move(constraints)),
      layout_(lay_out(body, constraints_)),
      loads_n_(body.external_forces_n()),
      force_floor_n_(1e-9 * body.material().youngs_modulus_pa * body.size_m() * body.size_m()),
      matrix_(layout_.node_count + layout_.point_count, layout_.all_cliques(body.mesh())),
      factor_(matrix_),
      elements_(body, matrix_),
      ties_(matrix_, layout_.ties) {
  for (const auto& cliques : layout_.cliques) adders_.emplace_back(matrix_, cliques);
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
    result.laws.push_back(constraints_[i]->law(result.values.back(), y));
    if (y != 0.0) constraints_[i]->add_gradient(state.positions_m, y, result.residual_n);
    const ConstraintLaw& law = result.laws.back();
    // Relative to the constraint's own value, so that lengths and volumes count alike; a prescribed multiplier is met
    // or not.
    const double off = law.prescribed()
                           ? (std::abs(y - law.min_multiplier) > 1e-12 * std::abs(y) ? 1.0 : 0.0)
                           : std::abs(violation(law, y)) / std::max(std::abs(result.values.back()), 1e-300);
    constraint_residual = std::max(constraint_residual, off);
  }
  release(result.residual_n);
  const double volume_residual =
      elements_.mismatch(result.elements.growth, state.element_multipliers_pa).cwiseAbs().maxCoeff();
  result.relative_residual = std::max({result.residual_n.norm() / largest, constraint_residual, volume_residual});
  result.finite =
      std::isfinite(result.relative_residual) && std::isfinite(result.smooth_energy) && result.residual_n.allFinite();
  return result;
}

bool NewtonSolver::linearise(const NewtonState& state, double inertia_per_s2, bool convex) {
  linearisation_.reset();
  matrix_.set_zero();
  elements_.add_hessian(state.positions_m, state.element_multipliers_pa, convex, matrix_);
  if (!add_rest_and_factorise(state, inertia_per_s2)) return false;
  if (!convex) linearisation_ = std::make_shared<Linearisation>(Linearisation{state, inertia_per_s2});
  return true;
}

bool NewtonSolver::add_rest_and_factorise(const NewtonState& state, double inertia_per_s2) {
  if (inertia_per_s2 > 0.0) {
    for (int node = 0; node < layout_.node_count; ++node)
      matrix_.add_to_diagonal(node, inertia_per_s2 * body_.node_masses_kg()[node]);
  }
  for (int i = 0; i < constraint_count(); ++i)
    if (state.constraint_multipliers[i] != 0.0)
      constraints_[i]->add_hessian(state.positions_m, state.constraint_multipliers[i], adders_[i]);
  const double tie = kTieStiffness * body_.material().youngs_modulus_pa * body_.size_m();
  for (int point = 0; point < layout_.point_count; ++point)
    ties_.add_outer(point, layout_.tie_coefficients[point], tie * Eigen::Matrix3d::Identity());
  matrix_.hold(body_.fixed());
  if (!factor_.factorise(matrix_)) return false;
  border_ = border(state.positions_m);
  border_solved_ = solve(border_);
  return true;
}

bool NewtonSolver::linearised_at(const NewtonState& state, double inertia_per_s2) const {
  return linearisation_ && linearisation_->inertia_per_s2 == inertia_per_s2 &&
         linearisation_->at.positions_m == state.positions_m &&
         linearisation_->at.element_multipliers_pa == state.element_multipliers_pa &&
         linearisation_->at.constraint_multipliers == state.constraint_multipliers;
}

void NewtonSolver::restore(const std::shared_ptr<const Linearisation>& linearisation) {
  if (linearisation == linearisation_) return;
  linearisation_.reset();
  if (linearisation) linearise(linearisation->at, linearisation->inertia_per_s2, false);
}

Eigen::MatrixXd NewtonSolver::solve(const Eigen::MatrixXd& right_hand_sides) const {
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(3 * matrix_.node_count(), right_hand_sides.cols());
  x.topRows(right_hand_sides.rows()) = right_hand_sides;
  factor_.solve(x);
  return x.topRows(right_hand_sides.rows());
}

// Whether the energy has a minimum on the active constraints, though A itself may not be positive definite: a buckled
// body is held by its cables' lengths. So it is where the Schur complement has as many negative eigenvalues as A
// (Haynsworth 1968: the inertia of the bordered matrix).
bool NewtonSolver::stable_under(const Eigen::MatrixXd& schur, const std::vector<ConstraintLaw>& laws,
                                const Eigen::VectorXd& multipliers) const {
  if (factor_.negative_pivots() == 0) return true;
  std::vector<int> free;
  for (int i = 0; i < constraint_count(); ++i)
    if (active(laws[i], multipliers[i])) free.push_back(i);
  const int size = static_cast<int>(free.size());
  if (size < factor_.negative_pivots()) return false;
  Eigen::MatrixXd sub(size, size);
  for (int i = 0; i < size; ++i)
    for (int j = 0; j < size; ++j) sub(i, j) = schur(free[i], free[j]);
  const Eigen::VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(sub, Eigen::EigenvaluesOnly).eigenvalues();
  return (eigenvalues.array() < 0.0).count() == factor_.negative_pivots();
}

bool NewtonSolver::find_step(const NewtonState& state, const Evaluation& here, Step& step) const {
  const int count = constraint_count();
  const Eigen::VectorXd mismatch = elements_.mismatch(here.elements.growth, state.element_multipliers_pa);
  Eigen::Matrix3Xd gradient = Eigen::Matrix3Xd::Zero(3, state.positions_m.cols());
  elements_.add_mismatch_forces(mismatch, gradient);
  release(gradient);
  gradient += here.residual_n;

  // The residual holds the forces of the old multipliers already, so the border answers only for their change.
  Eigen::VectorXd motion = solve(-as_vector(gradient));
  step.constraint_multipliers.resize(count);
  step.penalties.resize(count);
  step.laws = here.laws;
  for (int i = 0; i < count; ++i) step.laws[i].offset -= here.values[i];
  if (count > 0) {
    Eigen::MatrixXd schur = border_.transpose() * border_solved_;
    Eigen::VectorXd right = border_.transpose() * motion + schur * state.constraint_multipliers;
    for (int i = 0; i < count; ++i) {
      step.penalties[i] = 1.0 / std::max(std::abs(schur(i, i)) + here.laws[i].compliance, 1e-300);
      schur(i, i) += here.laws[i].compliance;
      right[i] += here.laws[i].offset;
    }
    step.constraint_multipliers = solve_bounded(schur, right, here.laws);
    if (!stable_under(schur, here.laws, step.constraint_multipliers)) return false;
    motion -= border_solved_ * (step.constraint_multipliers - state.constraint_multipliers);
  }
  if (count == 0 && factor_.negative_pivots() > 0) return false;
  if (!motion.allFinite()) return false;
  step.motion_m = Eigen::Map<const Eigen::Matrix3Xd>(motion.data(), 3, state.positions_m.cols());
  step.element_multipliers_pa = elements_.updated_multipliers(here.elements.growth, step.motion_m);

  // Slope of the merit function; -slope = dx' A dx without its volumetric part, plus the penalties' decrease.
  const Eigen::VectorXd c = elements_.mismatch(here.elements.growth, step.element_multipliers_pa);
  const double squared = c.cwiseAbs2().dot(elements_.rest_volumes_m3());
  step.slope = as_vector(gradient).dot(motion) + (elements_.lambda_pa() - kPenaltyOverMu * elements_.mu_pa()) * squared;
  step.slope += (step.constraint_multipliers - state.constraint_multipliers).dot(border_.transpose() * motion);
  for (int i = 0; i < count; ++i)
    step.slope -= step.penalties[i] * std::pow(violation(here.laws[i], step.constraint_multipliers[i]), 2);
  return std::isfinite(step.slope);
}

// One step by the last factor, kept only where it brings the residual well down. Volume and constraint multipliers stay
// unknowns of their own, so it converges as fast as the body has turned little, however incompressible it is.
bool NewtonSolver::try_old_factor(const NewtonTask& task, NewtonState& state, Evaluation& here) const {
  if (!linearisation_ || linearisation_->inertia_per_s2 != task.inertia_per_s2) return false;
  Step step;
  if (!find_step(state, here, step)) return false;
  NewtonState trial{state.positions_m + step.motion_m, step.element_multipliers_pa, step.constraint_multipliers};
  Evaluation there = evaluate(task, trial);
  if (!there.finite || there.relative_residual > kWorthwhileDecrease * here.relative_residual) return false;
  state = std::move(trial);
  here = std::move(there);
  return true;
}

double NewtonSolver::merit(const Evaluation& at, const Step& step) const {
  // Augmented Lagrangian at the step's multipliers: the mixed problem has no energy of its own to descend, and the
  // condensed energy would refuse every step that changes volume a little on the way.
  const Eigen::VectorXd& p = step.element_multipliers_pa;
  const Eigen::VectorXd c = elements_.mismatch(at.elements.growth, p);
  double sum = at.smooth_energy;
  sum +=
      (p.cwiseProduct(c) + 0.5 * kPenaltyOverMu * elements_.mu_pa() * c.cwiseAbs2()).dot(elements_.rest_volumes_m3());
  for (int i = 0; i < constraint_count(); ++i) {
    const double y = step.constraint_multipliers[i];
    ConstraintLaw law = step.laws[i];
    law.offset += at.values[i];
    sum += y * at.values[i] + 0.5 * step.penalties[i] * std::pow(violation(law, y), 2);
  }
  return sum;
}

// Goes along the step as far as the merit function falls; false where it does not.
bool NewtonSolver::search_line(const NewtonTask& task, const Step& step, NewtonState& state, Evaluation& here,
                               double& length) const {
  const double start = merit(here, step);
  length = 1.0;
  for (int halving = 0; halving <= kHalvings; ++halving, length *= 0.5) {
    NewtonState trial = state;
    trial.positions_m += length * step.motion_m;
    trial.element_multipliers_pa += length * (step.element_multipliers_pa - state.element_multipliers_pa);
    trial.constraint_multipliers += length * (step.constraint_multipliers - state.constraint_multipliers);
    Evaluation there = evaluate(task, trial);
    if (!there.finite) continue;
    const double allowed = start + 1e-4 * length * step.slope + 1e-12 * std::abs(start);
    if (merit(there, step) > allowed && there.relative_residual > 0.5 * here.relative_residual) continue;
    state = std::move(trial);
    here = std::move(there);
    return true;
  }
  return false;
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

  bool convex = false, old_factor = task.reuse_factor;
  while (report.iterations < task.max_iterations) {
    if (report.iterations >= task.min_iterations && here.relative_residual <= task.tolerance) return finish("");
    ++report.iterations;
    if (old_factor && try_old_factor(task, state, here)) continue;
    old_factor = false;

    Step step;
    const auto fresh_step = [&] {
      if (!convex && linearised_at(state, task.inertia_per_s2)) return find_step(state, here, step);
      ++report.factorisations;
      return linearise(state, task.inertia_per_s2, convex) && find_step(state, here, step);
    };
    bool found = fresh_step();
    if (!convex && (!found || step.slope > 0.0)) {
      convex = true;
      found = fresh_step();
    }
    if (convex) ++report.convexified;
    if (!found) return finish("the stiffness matrix could not be factorised");

    double length = 1.0;
    const bool accepted = search_line(task, step, state, here, length);
    if (length < 1.0) ++report.shortened;
    if (!accepted && convex) return finish("no step lowers the energy");
    convex = !accepted || (convex && length < 1.0);
    old_factor = accepted && task.reuse_factor && !convex;
  }
  return finish(here.relative_residual <= task.tolerance ? "" : "iteration limit");
}

Eigen::MatrixXd NewtonSolver::sensitivities(const NewtonState& state) {
  if (!linearised_at(state, 0.0) && !linearise(state, 0.0, false)) return {};
  const int count = constraint_count();
  Eigen::MatrixXd schur = border_.transpose() * border_solved_;
  std::vector<ConstraintLaw> laws;
  for (int i = 0; i < count; ++i)
    laws.push_back(constraints_[i]->law(constraints_[i]->value(state.positions_m), state.constraint_multipliers[i]));
  for (int i = 0; i < count; ++i) schur(i, i) += laws[i].compliance;
  if (!stable_under(schur, laws, state.constraint_multipliers)) return {};
  Eigen::MatrixXd drive = Eigen::MatrixXd::Zero(count, count);  // rows: constraints, columns: commands
  for (int i = 0; i < count; ++i) {
    if (active(laws[i], state.constraint_multipliers[i])) {
      drive(i, i) = laws[i].offset_per_command;
      continue;
    }
    // dy is known, zero for a slack cable: replace the row by dy = given.
    schur.row(i).setZero();
    schur(i, i) = 1.0;
    drive(i, i) = laws[i].prescribed() ? laws[i].multiplier_per_command : 0.0;
  }
  if (count == 0) return border_solved_;
  return -border_solved_ * schur.fullPivLu().solve(drive);
}

}  // namespace soft_robot_lab
