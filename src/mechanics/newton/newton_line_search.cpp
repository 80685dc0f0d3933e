// SPDX-License-Identifier: BSD-3-Clause
// The merit function of Newton's steps, and how far along one it falls.
#include <algorithm>
#include <cmath>

#include "mechanics/contact/contact_step.h"
#include "mechanics/contact/swept_obstacles.h"
#include "newton_solver.h"
#include "mechanics/solver_constants.h"

namespace soft_robot_lab {
void NewtonSolver::prepare_merit(const NewtonState& state, const Evaluation& here, const Eigen::Matrix3Xd& gradient_n,
                                 Step& step) const {
  // Slope of the merit function; -slope = dx' A dx without its volumetric part, plus the penalties' decrease.
  const Eigen::VectorXd c = energies_.elements.mismatch(here.elements.volumetric_strain, step.element_multipliers_pa);
  step.slope = as_vector(gradient_n).dot(as_vector(step.motion_m)) +
               energies_.elements.sum_of_squares(
                   energies_.elements.lambda_pa() - constants::kPenaltyOverMu * energies_.elements.mu_pa(), c);
  step.slope += (step.constraint_multipliers - state.constraint_multipliers)
                    .dot(system_.border().columns.transpose() * as_vector(step.motion_m));
  step.laws = after_flows(here.laws, here.friction_contacts, step.slips_m);
  for (int i = 0; i < constraint_count(); ++i) {
    step.slope -= step.penalties[i] * std::pow(violation(step.laws[i], step.constraint_multipliers[i]), 2);
    step.laws[i].offset -= here.values[i];
  }
  step.slope +=
      slope_change_j(energies_.contact, step.contact_start, step.contact_pressures_pa, step.motion_m, step.free_motion);
  if (system_.free_border().empty()) return;
  step.slope += here.free_residual.cwiseProduct(step.free_motion).sum() +
                energies_.contact.rigid().slope_change_j(here.contact.rigid, step.rigid_forces_n, step.free_motion);
}

double NewtonSolver::merit(const Evaluation& at, const Step& step) const {
  // Augmented Lagrangian at the step's multipliers: the mixed problem has no energy of its own to descend, and the
  // condensed energy would refuse every step that changes volume a little on the way.
  const Eigen::VectorXd& p = step.element_multipliers_pa;
  const Eigen::VectorXd c = energies_.elements.mismatch(at.elements.volumetric_strain, p);
  double sum = at.smooth_energy;
  sum +=
      (p.cwiseProduct(c) + (0.5 * constants::kPenaltyOverMu * energies_.elements.mu_pa()).cwiseProduct(c.cwiseAbs2()))
          .dot(energies_.elements.rest_volumes_m3());
  for (int i = 0; i < constraint_count(); ++i) {
    const double y = step.constraint_multipliers[i];
    ConstraintLaw law = step.laws[i];
    law.offset += at.values[i];
    sum += y * at.values[i] + 0.5 * step.penalties[i] * std::pow(violation(law, y), 2);
  }
  sum += merit_j(energies_.contact, at.contact, step.contact_start, step.contact_pressures_pa);
  if (!system_.free_border().empty())
    sum += energies_.contact.rigid().merit_j(at.contact.rigid, step.contact_start.rigid, step.rigid_forces_n);
  return sum;
}

ContactState NewtonSolver::after(const NewtonState& state, const Step& step, double length) const {
  ContactState contact = state.contact;
  contact.pressures_pa += length * (step.contact_pressures_pa - contact.pressures_pa);
  if (system_.free_border().empty()) return contact;
  contact.rigid_forces_n += length * (step.rigid_forces_n - contact.rigid_forces_n);
  contact.free = moved(contact.free, length * step.free_motion);
  return contact;
}

// A free obstacle that nothing holds yet would fly anywhere.
double NewtonSolver::first_length(const Step& step) const {
  double length = 1.0;
  for (Eigen::Index i = 0; i < step.free_motion.cols() / 2; ++i) {
    const double way_m = step.free_motion.col(2 * i).norm(), turn_rad = step.free_motion.col(2 * i + 1).norm();
    length = std::min({length, energies_.contact.free().size_m(static_cast<int>(i)) / std::max(way_m, 1e-300),
                       1.0 / std::max(turn_rad, 1e-300)});
  }
  return length;
}

// Goes along the step as far as the merit function falls; false where it does not.
bool NewtonSolver::search_line(const NewtonTask& task, const Step& step, NewtonState& state, Evaluation& here,
                               double& length) const {
  if (system_.skin_in_border()) here.contact = step.contact_start;
  const double start = merit(here, step);
  const auto part_allowed = [&](const Eigen::Matrix3Xd& motion_m) {
    return part_before_obstacles(body_, energies_.contact, state.positions_m, motion_m, state.contact);
  };
  length = std::min({first_length(step), energies_.contact.skin().first_length(state.positions_m, step.motion_m),
                     part_allowed(step.motion_m)});
  for (int halving = 0; halving <= constants::kLineSearchHalvings; ++halving, length *= 0.5) {
    NewtonState trial = state;
    trial.positions_m = tables_->co_rotation().follow(state.positions_m, length * step.motion_m);
    trial.element_multipliers_pa += length * (step.element_multipliers_pa - state.element_multipliers_pa);
    trial.constraint_multipliers += length * (step.constraint_multipliers - state.constraint_multipliers);
    trial.slips_m += length * (step.slips_m - state.slips_m);
    trial.contact = after(state, step, length);
    if (part_allowed(trial.positions_m - state.positions_m) < 1.0) continue;
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

}  // namespace soft_robot_lab
