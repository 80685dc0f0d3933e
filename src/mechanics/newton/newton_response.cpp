// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iterator>

#include <Eigen/LU>

#include "mechanics/solver_constants.h"
#include "newton_solver.h"
#include "slip_rates.h"

namespace soft_robot_lab {

ConstraintLaw NewtonSolver::law_at(const NewtonState& state, int constraint) const {
  const DrivenConstraint& of = constraints_[static_cast<std::size_t>(constraint)];
  return of.law(of.value(state.positions_m, state.drives), state.constraint_multipliers[constraint], state.drives);
}

MultiplierProblem NewtonSolver::problem_at(const NewtonState& state, const Eigen::MatrixXd& border_solved) const {
  MultiplierProblem problem;
  problem.delassus = system_.border().columns.transpose() * border_solved;
  problem.friction_contacts = junctions_at(state.positions_m);
  for (int i = 0; i < constraint_count(); ++i) problem.laws.push_back(law_at(state, i));
  for (int i = 0; i < constraint_count(); ++i) problem.delassus(i, i) += problem.laws[i].compliance;
  return problem;
}

NewtonDrive NewtonSolver::with_slips(const NewtonDrive& drive, const TouchesAtLimit& at_limit) const {
  const Eigen::Index columns = drive.offsets.cols(), slips = at_limit.count();
  const auto widened = [&](const Eigen::MatrixXd& given, Eigen::Index rows) {
    Eigen::MatrixXd wide = Eigen::MatrixXd::Zero(rows, columns + slips);
    if (given.size() > 0) wide.leftCols(columns) = given;
    return wide;
  };
  NewtonDrive wide{widened(drive.forces_n, 3 * tables_->layout.node_count), widened(drive.offsets, constraint_count()),
                   widened(drive.multipliers, constraint_count()), widened(drive.log_ratios, friction_contact_count()),
                   widened(drive.free_forces, 6 * energies_.contact.free().count())};
  Eigen::Matrix3Xd force_n(3, tables_->layout.node_count);
  FreeColumns free(3, 2 * energies_.contact.free().count());
  for (Eigen::Index i = 0; i < slips; ++i) {
    force_n.setZero();
    free.setZero();
    add_slip(energies_.contact, at_limit, i, force_n, free);
    tables_->release(force_n);
    wide.forces_n.col(columns + i) = as_vector(force_n);
    wide.free_forces.col(columns + i) = free.reshaped();
  }
  return wide;
}

// Sticking ties are in the matrix. A slip is a force that takes off what its traction has too much, and all slips
// together are a linear complementarity problem.
NewtonResponse NewtonSolver::respond(const NewtonState& state, const NewtonDrive& drive) {
  if (!system_.linearise_held(state)) return {};
  system_.find_edges(state.positions_m);
  TouchesAtLimit at_limit;
  const auto held = [](const auto& touch) { return touch.friction.held; };
  std::copy_if(system_.touches().begin(), system_.touches().end(), std::back_inserter(at_limit.points), held);
  std::copy_if(system_.rigid_touches().begin(), system_.rigid_touches().end(), std::back_inserter(at_limit.rigid),
               held);
  if (at_limit.count() == 0) return respond_held(state, drive);
  NewtonResponse all = respond_held(state, with_slips(drive, at_limit));
  if (!all.stable) return {};
  const Eigen::Index columns = drive.offsets.cols(), slips = at_limit.count();
  Eigen::MatrixXd beyond_m(slips, columns + slips);
  for (Eigen::Index column = 0; column < beyond_m.cols(); ++column)
    beyond_m.col(column) = beyond_limits_m(
        energies_.contact, at_limit,
        Eigen::Map<const Eigen::Matrix3Xd>(all.motions_m.col(column).data(), 3, tables_->layout.node_count),
        all.free_motions.col(column).reshaped(3, all.free_motions.rows() / 3));
  const Eigen::VectorXd pull_n = limits_n(energies_.contact, at_limit);
  const Eigen::MatrixXd coupling = beyond_m.rightCols(slips);
  const Eigen::MatrixXd going_on = slips_of_all(coupling, beyond_m.leftCols(columns));
  Eigen::MatrixXd rates_m(slips, columns);
  for (Eigen::Index column = 0; column < columns; ++column) {
    const double way = pull_n.dot(going_on.col(column)) < 0.0 ? -1.0 : 1.0;
    rates_m.col(column) = way * slip_rates(coupling, way * beyond_m.col(column));
  }
  const auto together = [&](const Eigen::MatrixXd& of) -> Eigen::MatrixXd {
    return of.leftCols(columns) + of.rightCols(slips) * rates_m;
  };
  return {true,
          together(all.motions_m),
          together(all.multipliers),
          together(all.slips_m),
          together(all.free_motions),
          static_cast<int>(slips)};
}

// S dy + D dq = d offset - B' A^-1 d force on active constraints, dy given on the others; at a contact dq = 0, or
// where it slips d(y_first - ratio y_second) = 0, in which the ratio follows dx. Then dx = -A^-1 (d force + B dy).
NewtonResponse NewtonSolver::respond_held(const NewtonState& state, const NewtonDrive& drive) const {
  const int count = constraint_count(), friction_contacts = friction_contact_count();
  const Eigen::VectorXd& y = state.constraint_multipliers;
  const auto& [border_solved, border_free] = system_.solve_exactly(system_.border().columns);
  const MultiplierProblem problem = problem_at(state, border_solved);
  if (!stable_under(problem, y)) return {};

  const bool forced = drive.forces_n.size() > 0;
  NewtonResponse response;
  response.stable = true;
  if (forced) {
    LinearSystem::ExactMotions motions = system_.solve_exactly(-drive.forces_n, -drive.free_forces);
    response.motions_m = std::move(motions.motions_m);
    response.free_motions = std::move(motions.free);
  } else {
    response.motions_m.setZero(state.positions_m.size(), drive.offsets.cols());
    response.free_motions.setZero(border_free.rows(), drive.offsets.cols());
  }
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(count + friction_contacts, count + friction_contacts);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(count + friction_contacts, drive.offsets.cols());
  for (int i = 0; i < count; ++i) {
    if (active(problem.laws[i], y[i])) {
      matrix.row(i).head(count) = problem.delassus.row(i);
      right.row(i) = drive.offsets.row(i);
      if (forced) right.row(i) += system_.border().columns.col(i).transpose() * response.motions_m;
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
    matrix.row(row).head(count) = as_vector(gradient).transpose() * border_solved;
    matrix(row, first) += slip > 0 ? 1.0 : -ratio;
    matrix(row, second) += slip > 0 ? -ratio : 1.0;
    if (drive.log_ratios.size() > 0) right.row(row) += scale * drive.log_ratios.row(j);
    if (forced) right.row(row) += as_vector(gradient).transpose() * response.motions_m;
  }
  const Eigen::MatrixXd solved = count > 0 ? Eigen::MatrixXd(matrix.fullPivLu().solve(right)) : Eigen::MatrixXd(right);
  response.multipliers = solved.topRows(count);
  response.slips_m = solved.bottomRows(friction_contacts);
  response.motions_m -= border_solved * response.multipliers;
  response.free_motions -= border_free * response.multipliers;
  return response;
}

Eigen::Matrix3Xd NewtonSolver::reaction_forces_n(const NewtonState& state) const {
  Eigen::Matrix3Xd force_n = -energies_.loads.all_n();
  energies_.elements.add_gradient(state.positions_m, state.element_multipliers_pa, force_n);
  for (int i = 0; i < constraint_count(); ++i)
    constraints_[i].add_gradient(state.positions_m, state.drives, state.constraint_multipliers[i], force_n);
  energies_.terms.add_gradient(state.positions_m, state.drives, force_n);
  energies_.contact.add_forces(energies_.contact.sums(state.positions_m, state.contact), force_n);
  return body_.fixed().array().select(force_n.array(), 0.0).matrix();
}

NewtonForces NewtonSolver::forces(const NewtonState& state,
                                  const std::shared_ptr<const StrainTarget>& strain_target) const {
  const Eigen::Matrix3Xd none = Eigen::Matrix3Xd::Zero(3, state.positions_m.cols());
  NewtonForces all{none, none, none, none, 0.0, 0.0, {}, {}, {}};
  const ElementSums sums =
      energies_.elements.add_gradient(state.positions_m, state.element_multipliers_pa, all.elastic_n);
  all.elastic_j = sums.elastic_energy + energies_.volumetric_energy_j(sums);
  energies_.terms.add_gradient(state.positions_m, state.drives, all.driven_n);
  if (strain_target) {
    energies_.springs.add_gradient(state.positions_m, *strain_target, all.viscous_n);
    all.viscous_n += energies_.volume_damping_n(*strain_target, sums.volumetric_strain, state.positions_m);
  }
  const ContactSums touching = energies_.contact.sums(state.positions_m, state.contact);
  energies_.contact.add_forces(touching, all.contact_n);
  all.rubbed_j = rubbed_j(energies_.contact, touching);
  all.free_n = energies_.contact.free_forces_n(touching);
  for (int i = 0; i < constraint_count(); ++i) {
    all.values.push_back(constraints_[i].value(state.positions_m, state.drives));
    all.pulls_n.push_back(none);
    constraints_[i].add_gradient(state.positions_m, state.drives, state.constraint_multipliers[i], all.pulls_n.back());
  }
  return all;
}

StepWork NewtonSolver::work(const NewtonState& state, const std::shared_ptr<const StrainTarget>& strain_target,
                            const Eigen::Matrix3Xd& inertia_n, const Eigen::Matrix3Xd& way_m,
                            const FreeColumns& free_way, bool with_reactions) const {
  const bool known = !with_reactions && end_.positions_m.cols() == way_m.cols() &&
                     end_.positions_m == state.positions_m &&
                     end_.element_multipliers_pa == state.element_multipliers_pa;
  StepWork all;
  // All that acts on a node, the reaction with it; of a solve that just ended its residual, as held nodes do not move.
  Eigen::Matrix3Xd net_n = known ? end_.at.residual_n : Eigen::Matrix3Xd(inertia_n - energies_.loads.all_n());
  double others_j = (inertia_n - energies_.loads.all_n()).cwiseProduct(way_m).sum();
  const auto take = [&](const Eigen::Matrix3Xd& forces_n) {
    if (!known) net_n += forces_n;
    const double work_j = forces_n.cwiseProduct(way_m).sum();
    others_j += work_j;
    return work_j;
  };
  ElementSums sums = known ? end_.at.elements
                           : energies_.elements.add_gradient(state.positions_m, state.element_multipliers_pa, net_n);
  if (known && strain_target && strain_target->volume_ratio > 0.0)
    sums.volumetric_strain += strain_target->free_volume();
  const Eigen::Matrix3Xd none = Eigen::Matrix3Xd::Zero(3, way_m.cols());
  Eigen::Matrix3Xd forces_n;
  all.elastic_energy_j = sums.elastic_energy + energies_.volumetric_energy_j(sums);
  if (!energies_.terms.empty()) {
    energies_.terms.add_gradient(state.positions_m, state.drives, forces_n = none);
    all.driven_j = take(forces_n);
  }
  if (strain_target) {
    all.viscous_n = none;
    energies_.springs.add_gradient(state.positions_m, *strain_target, all.viscous_n);
    all.viscous_j = take(all.viscous_n);
    const Eigen::Matrix3Xd of_volume_n =
        energies_.volume_damping_n(*strain_target, sums.volumetric_strain, state.positions_m);
    const double of_volume_j = of_volume_n.cwiseProduct(way_m).sum();
    all.viscous_n += of_volume_n;  // among all forces already, by the multipliers
    all.viscous_j += of_volume_j;
    others_j += of_volume_j;
  }
  if (!energies_.contact.empty()) {
    const ContactSums touching = known ? end_.at.contact : energies_.contact.sums(state.positions_m, state.contact);
    energies_.contact.add_forces(touching, forces_n = none);
    all.contact_j = take(forces_n) + energies_.contact.free_forces_n(touching).cwiseProduct(free_way).sum();
    all.rubbed_j = rubbed_j(energies_.contact, touching);
  }
  for (int i = 0; i < constraint_count(); ++i) {
    all.values.push_back(known ? end_.at.values[static_cast<std::size_t>(i)]
                               : constraints_[i].value(state.positions_m, state.drives));
    constraints_[i].add_gradient(state.positions_m, state.drives, state.constraint_multipliers[i], forces_n = none);
    all.pulls_j.push_back(take(forces_n));
  }
  all.elastic_j = net_n.cwiseProduct(way_m).sum() - others_j;
  if (with_reactions) all.reactions_n = body_.fixed().array().select(net_n.array(), 0.0).matrix();
  return all;
}

Eigen::VectorXd NewtonSolver::elastic_force_n(const NewtonState& state) const {
  Eigen::Matrix3Xd pressed_n = Eigen::Matrix3Xd::Zero(3, energies_.loads.all_n().cols());
  energies_.contact.add_forces(energies_.contact.sums(state.positions_m, state.contact), pressed_n);
  energies_.terms.add_gradient(state.positions_m, state.drives, pressed_n);
  Eigen::Matrix3Xd force_n = energies_.loads.all_n() - pressed_n;
  tables_->release(force_n);
  return as_vector(force_n) - constraint_gradients(*tables_, state) * state.constraint_multipliers;
}

Eigen::MatrixXd NewtonSolver::sensitivities(const NewtonState& state, Eigen::MatrixXd* multipliers) {
  const int count = constraint_count(), columns = count + tables_->term_count();
  NewtonDrive commands{{}, Eigen::MatrixXd::Zero(count, columns), Eigen::MatrixXd::Zero(count, columns), {}};
  if (tables_->term_count() > 0) commands.forces_n = Eigen::MatrixXd::Zero(state.positions_m.size(), columns);
  for (int i = 0; i < tables_->term_count(); ++i) {
    const DrivenTerm& driven = energies_.terms.driven()[static_cast<std::size_t>(i)];
    Eigen::Matrix3Xd gradient = Eigen::Matrix3Xd::Zero(3, state.positions_m.cols());
    driven.term->add_command_gradient(state.positions_m, driven.drive(state.drives), gradient);
    tables_->release(gradient);
    commands.forces_n.col(count + i) = as_vector(gradient);
  }
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
