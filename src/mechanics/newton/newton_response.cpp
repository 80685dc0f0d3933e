// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/LU>

#include "newton_solver.h"

namespace soft_robot_lab {

ConstraintLaw NewtonSolver::law_at(const NewtonState& state, int constraint) const {
  const DrivenConstraint& of = constraints_[static_cast<std::size_t>(constraint)];
  return of.law(of.value(state.positions_m, state.drives), state.constraint_multipliers[constraint], state.drives);
}

// S dy + D dq = d offset - B' A^-1 d force on active constraints, dy given on the others; at a contact dq = 0, or
// where it slips d(y_first - ratio y_second) = 0, in which the ratio follows dx. Then dx = -A^-1 (d force + B dy).
NewtonResponse NewtonSolver::respond(const NewtonState& state, const NewtonDrive& drive) {
  if (!linearised_at(state, 0.0, nullptr) && !linearise(state, 0.0, nullptr, false)) return {};
  const int count = constraint_count(), friction_contacts = friction_contact_count();
  const Eigen::VectorXd& y = state.constraint_multipliers;
  MultiplierProblem problem;
  problem.delassus = border_.transpose() * border_solved_;
  problem.friction_contacts = junctions_at(state.positions_m);
  for (int i = 0; i < count; ++i) problem.laws.push_back(law_at(state, i));
  for (int i = 0; i < count; ++i) problem.delassus(i, i) += problem.laws[i].compliance;
  if (!stable_under(problem, y)) return {};

  const bool forced = drive.forces_n.size() > 0;
  NewtonResponse response;
  response.stable = true;
  response.motions_m = forced ? Eigen::MatrixXd(-solve(drive.forces_n))
                              : Eigen::MatrixXd::Zero(state.positions_m.size(), drive.offsets.cols());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(count + friction_contacts, count + friction_contacts);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(count + friction_contacts, drive.offsets.cols());
  for (int i = 0; i < count; ++i) {
    if (active(problem.laws[i], y[i])) {
      matrix.row(i).head(count) = problem.delassus.row(i);
      right.row(i) = drive.offsets.row(i);
      if (forced) right.row(i) += border_.col(i).transpose() * response.motions_m;
    } else {  // dy is known, zero for a slack cable
      matrix(i, i) = 1.0;
      if (problem.laws[i].prescribed()) right.row(i) = drive.multipliers.row(i);
    }
  }
  for (int j = 0; j < friction_contacts; ++j) {
    const auto& [first, second, ratio] = problem.friction_contacts[j];
    const int row = count + j;
    const bool held_first = !active(problem.laws[first], y[first]),
               held_second = !active(problem.laws[second], y[second]);
    if (!held_first) matrix(first, row) = 1.0;
    if (!held_second) matrix(second, row) = -1.0;
    const int slip = slipping(problem.friction_contacts[j], y);
    if (slip == 0 || (held_first && held_second)) {
      matrix(row, row) = 1.0;
      continue;
    }
    const double scale = ratio * y[slip > 0 ? second : first];
    Eigen::Matrix3Xd gradient = Eigen::Matrix3Xd::Zero(3, state.positions_m.cols());
    shared_[j].contact->add_log_ratio_gradient(state.positions_m, scale, gradient);
    matrix.row(row).head(count) = as_vector(gradient).transpose() * border_solved_;
    matrix(row, first) += slip > 0 ? 1.0 : -ratio;
    matrix(row, second) += slip > 0 ? -ratio : 1.0;
    if (drive.log_ratios.size() > 0) right.row(row) += scale * drive.log_ratios.row(j);
    if (forced) right.row(row) += as_vector(gradient).transpose() * response.motions_m;
  }
  const Eigen::MatrixXd solved = count > 0 ? Eigen::MatrixXd(matrix.fullPivLu().solve(right)) : Eigen::MatrixXd(right);
  response.multipliers = solved.topRows(count);
  response.slips_m = solved.bottomRows(friction_contacts);
  response.motions_m -= border_solved_ * response.multipliers;
  return response;
}

Eigen::Matrix3Xd NewtonSolver::reaction_forces_n(const NewtonState& state) const {
  Eigen::Matrix3Xd force_n = -loads_n_;
  elements_.add_gradient(state.positions_m, state.element_multipliers_pa, force_n);
  for (int i = 0; i < constraint_count(); ++i)
    constraints_[i].add_gradient(state.positions_m, state.drives, state.constraint_multipliers[i], force_n);
  contact_.add_forces(contact_.sums(state.positions_m, state.contact), force_n);
  return body_.fixed().array().select(force_n.array(), 0.0).matrix();
}

Eigen::VectorXd NewtonSolver::elastic_force_n(const NewtonState& state) const {
  Eigen::Matrix3Xd pressed_n = Eigen::Matrix3Xd::Zero(3, loads_n_.cols());
  contact_.add_forces(contact_.sums(state.positions_m, state.contact), pressed_n);
  Eigen::Matrix3Xd force_n = loads_n_ - pressed_n;
  release(force_n);
  return as_vector(force_n) - border(state) * state.constraint_multipliers;
}

Eigen::MatrixXd NewtonSolver::sensitivities(const NewtonState& state, Eigen::MatrixXd* multipliers) {
  const int count = constraint_count();
  NewtonDrive commands{{}, Eigen::MatrixXd::Zero(count, count), Eigen::MatrixXd::Zero(count, count), {}};
  for (int i = 0; i < count; ++i) {
    const ConstraintLaw law = law_at(state, i);
    commands.offsets(i, i) = law.offset_per_command;
    commands.multipliers(i, i) = law.multiplier_per_command;
  }
  const NewtonResponse response = respond(state, commands);
  if (!response.stable) return {};
  if (multipliers) *multipliers = response.multipliers;
  return response.motions_m;
}

}  // namespace soft_robot_lab
