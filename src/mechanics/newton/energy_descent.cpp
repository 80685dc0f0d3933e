// SPDX-License-Identifier: BSD-3-Clause
// NewtonSolver::descend: Newton's method with positions as the only unknowns, made to go down from anywhere.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "mechanics/contact/contact_step.h"
#include "mechanics/contact/swept_obstacles.h"
#include "damped_bulk.h"
#include "newton_solver.h"
#include "mechanics/solver_constants.h"

namespace soft_robot_lab {
namespace {

// dU/dC of a constraint in series with a straight one of compliance `tie`; Newton's method, exact at once where the law
// is straight.
double multiplier(const DrivenConstraint& constraint, const SharedDrives& drives, double value, double tie, double y) {
  for (int i = 0; i < constants::kLawIterations; ++i) {
    const ConstraintLaw law = constraint.law(value, y, drives);
    const double before = y;
    y = law.prescribed() ? law.min_multiplier
                         : std::clamp(law.offset / (law.compliance + tie), law.min_multiplier, law.max_multiplier);
    if (std::abs(y - before) <= 1e-12 * std::abs(y)) break;
  }
  return y;
}

// U(to) - U(from): Gauss's three points in each of four parts.
double energy_between(const DrivenConstraint& constraint, const SharedDrives& drives, double tie, double y, double from,
                      double to) {
  constexpr int kParts = 4;
  constexpr std::array<double, 3> kPlaces{-0.7745966692414834, 0.0, 0.7745966692414834};
  constexpr std::array<double, 3> kWeights{5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  const double width = (to - from) / kParts;
  double sum = 0.0;
  for (int part = 0; part < kParts; ++part) {
    for (std::size_t i = 0; i < kPlaces.size(); ++i) {
      y = multiplier(constraint, drives, from + (part + 0.5 + 0.5 * kPlaces[i]) * width, tie, y);
      sum += kWeights[i] * width * y;
    }
  }
  return sum;
}

class SofterBulk {
 public:
  SofterBulk(Elements& elements, const StrainTarget* damping)
      : damped_(elements, damping), elements_(elements), lambda_pa_(elements.lambda_pa()) {
    elements_.set_lambda_pa(lambda_pa_.cwiseMin(constants::kSoftBulk * elements.mu_pa()));
  }
  ~SofterBulk() { elements_.set_lambda_pa(lambda_pa_); }
  SofterBulk(const SofterBulk&) = delete;
  SofterBulk& operator=(const SofterBulk&) = delete;

 private:
  const DampedBulk damped_;
  Elements& elements_;
  const Eigen::VectorXd lambda_pa_;
};

class SofterContact {
 public:
  explicit SofterContact(bool& soft) : soft_(soft) { soft_ = true; }
  ~SofterContact() { soft_ = false; }
  SofterContact(const SofterContact&) = delete;
  SofterContact& operator=(const SofterContact&) = delete;

 private:
  bool& soft_;
};

double lowered(double convexity) { return convexity <= 1.0 / 16.0 ? 0.0 : 0.5 * std::min(convexity, 1.0); }

double raised(double convexity) {
  if (convexity == 0.0) return 1.0 / 16.0;
  return convexity == 1.0 ? constants::kOnlySafe : std::min(1.0, 4.0 * convexity);
}

}  // namespace

// The energy but for that of the constraints, and its gradient but for volume and constraints.
NewtonSolver::EnergyAt NewtonSolver::energy_at(const NewtonTask& task, const Eigen::Matrix3Xd& positions_m,
                                               const SharedDrives& drives, const ContactState& contact) const {
  if (interrupt_) interrupt_->check();
  EnergyAt at;
  at.gradient_n = Eigen::Matrix3Xd::Zero(3, positions_m.cols());
  at.elements = energies_.elements.add_gradient(
      positions_m, Eigen::VectorXd::Zero(energies_.elements.multiplier_count()), at.gradient_n);
  at.energy = energies_.terms.add_gradient(positions_m, drives, at.gradient_n);
  at.gradient_n -= energies_.loads.all_n();
  if (task.strain_target && task.strain_target->volume_ratio > 0.0)
    at.elements.volumetric_strain -= task.strain_target->free_volume();
  at.energy += at.elements.elastic_energy - energies_.loads.all_n().cwiseProduct(positions_m).sum() +
               energies_.volumetric_energy_j(at.elements);
  if (task.inertia_per_s2 > 0.0) {
    const Eigen::Matrix3Xd lag = positions_m - *task.predicted_m;
    const Eigen::Matrix3Xd inertia = task.inertia_per_s2 * lag * body_.node_masses_kg().asDiagonal();
    at.energy += 0.5 * inertia.cwiseProduct(lag).sum();
    at.gradient_n += inertia;
  }
  if (task.strain_target) at.energy += energies_.springs.add_gradient(positions_m, *task.strain_target, at.gradient_n);
  for (const DrivenConstraint& constraint : constraints_) at.values.push_back(constraint.value(positions_m, drives));
  ContactSums sums;
  at.contact = contact;
  at.energy += soft_energy(energies_.contact, positions_m, contact.pressures_pa, at.contact, sums);
  energies_.contact.add_forces(sums, at.gradient_n);
  at.touches = std::move(sums.touches);
  return at;
}

double NewtonSolver::potential_rise_j(const NewtonTask& task, const NewtonState& from, const NewtonState& to) {
  const DampedBulk damped(energies_.elements, task.strain_target.get());
  ContactState contact = from.contact;
  contact.free = to.contact.free;
  const EnergyAt start = energy_at(task, from.positions_m, from.drives, from.contact),
                 end = energy_at(task, to.positions_m, from.drives, contact);
  std::vector<double> reached = end.values;  // what slipped into a part of a cable makes its length so much less
  for (int j = 0; j < friction_contact_count(); ++j) {
    reached[static_cast<std::size_t>(shared_[j].first)] -= to.slips_m[j];
    reached[static_cast<std::size_t>(shared_[j].second)] += to.slips_m[j];
  }
  const double tie = 1.0 / (constants::kTieStiffness * body_.material().youngs_modulus_pa * body_.size_m());
  double rise_j = end.energy - start.energy;
  FreeColumns weights_n = FreeColumns::Zero(3, 2 * energies_.contact.free().count());
  rise_j += add_free_gradient(energies_.contact.free(), to.contact.free, nullptr, weights_n) -
            add_free_gradient(energies_.contact.free(), from.contact.free, nullptr, weights_n);
  for (int i = 0; i < constraint_count(); ++i)
    rise_j += energy_between(constraints_[i], from.drives, tie, from.constraint_multipliers[i],
                             start.values[static_cast<std::size_t>(i)], reached[static_cast<std::size_t>(i)]);
  return rise_j;
}

// A positive matrix with as little convexity as that takes, from a little less than the last one had.
bool NewtonSolver::linearise_downhill(const NewtonTask& task, const NewtonState& state,
                                      const Eigen::VectorXd& volumetric_strain, double& convexity,
                                      NewtonReport& report) {
  for (convexity = lowered(convexity);; convexity = raised(convexity)) {
    ++report.factorisations;
    if (interrupt_) interrupt_->check();
    const bool positive =
        system_.linearise_blend(state, task.inertia_per_s2, task.strain_target, volumetric_strain, convexity) &&
        system_.negative_pivots() == 0;
    system_.forget_factor();
    if (positive || convexity > 1.0) return positive;
    ++report.convexified;
  }
}

// -(A + sum 1/a grad C grad C') ^ -1 gradient, the sum over the constraints that are off their bounds.
Eigen::VectorXd NewtonSolver::downhill(const Eigen::Matrix3Xd& gradient_n, const Eigen::VectorXd& compliances,
                                       const std::vector<int>& open) const {
  Eigen::VectorXd motion = system_.solve(-as_vector(gradient_n));
  const auto count = static_cast<Eigen::Index>(open.size());
  if (count == 0) return motion;
  Eigen::MatrixXd schur(count, count);
  Eigen::VectorXd right(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    right[i] = system_.border().columns.col(open[i]).dot(motion);
    for (Eigen::Index j = 0; j < count; ++j)
      schur(i, j) = system_.border().columns.col(open[i]).dot(system_.border().solved.col(open[j]));
    schur(i, i) += compliances[open[i]];
  }
  const Eigen::VectorXd forces = schur.partialPivLu().solve(right);
  for (Eigen::Index i = 0; i < count; ++i) motion -= system_.border().solved.col(open[i]) * forces[i];
  return motion;
}

NewtonReport NewtonSolver::descend(const NewtonTask& task, NewtonState& state) {
  NewtonReport report;
  const SofterBulk softer(energies_.elements, task.strain_target.get());
  const SofterContact softer_contact(energies_.soft_contact);
  const ContactState contact = state.contact;
  const double volume_m3 = energies_.elements.rest_volumes_m3().sum();
  const double no_slope = constants::kNoSlope * body_.material().lame_mu_pa() * volume_m3;
  const int count = constraint_count();
  Eigen::VectorXd ties;  // least compliances; known after the first factor, before which constraints have no say
  double convexity = 1.0;
  for (; report.iterations < constants::kDescentPatience * task.max_iterations; ++report.iterations) {
    const EnergyAt here = energy_at(task, state.positions_m, state.drives, contact);
    state.contact = here.contact;
    system_.take_touches(here.touches);
    state.element_multipliers_pa = energies_.elements.lambda_pa().cwiseProduct(here.elements.volumetric_strain);
    Eigen::VectorXd compliances = ties;
    std::vector<int> open;
    if (ties.size() == 0) state.constraint_multipliers.setZero();
    for (int i = 0; i < static_cast<int>(ties.size()); ++i) {
      double& y = state.constraint_multipliers[i];
      y = multiplier(constraints_[i], state.drives, here.values[i], ties[i], y);
      const ConstraintLaw law = constraints_[i].law(here.values[i], y, state.drives);
      compliances[i] += law.compliance;
      if (y > law.min_multiplier && y < law.max_multiplier) open.push_back(i);
    }
    if (!linearise_downhill(task, state, here.elements.volumetric_strain, convexity, report)) break;
    if (ties.size() == 0 && count > 0) {
      ties = constants::kSoftTie *
             system_.border().columns.cwiseProduct(system_.border().solved).colwise().sum().transpose();
      continue;
    }
    Eigen::Matrix3Xd gradient_n = here.gradient_n;
    energies_.elements.add_mismatch_forces(here.elements.volumetric_strain, gradient_n);
    for (int i = 0; i < count; ++i)
      constraints_[i].add_gradient(state.positions_m, state.drives, state.constraint_multipliers[i], gradient_n);
    tables_->release(gradient_n);
    const Eigen::VectorXd motion = downhill(gradient_n, compliances, open);
    const double slope = as_vector(gradient_n).dot(motion);
    if (!(slope < -no_slope)) break;

    const Eigen::Map<const Eigen::Matrix3Xd> way_m(motion.data(), 3, state.positions_m.cols());
    double length = part_before_contact(body_, energies_.contact, state.positions_m, way_m, state.contact);
    bool fell = false;
    for (int halving = 0; halving <= constants::kDescentHalvings && !fell; ++halving) {
      if (halving > 0) length *= 0.5;
      const Eigen::Matrix3Xd trial = state.positions_m + length * way_m;
      const EnergyAt there = energy_at(task, trial, state.drives, contact);
      double rise = there.energy - here.energy;
      for (int i = 0; i < count; ++i)
        rise += energy_between(constraints_[i], state.drives, ties[i], state.constraint_multipliers[i], here.values[i],
                               there.values[i]);
      fell = rise <= 1e-4 * length * slope;
      if (fell) state.positions_m = trial;
    }
    if (length < 1.0) ++report.shortened;
    if (!fell && convexity >= 1.0) break;
    if (length < 0.1) convexity = std::min(constants::kOnlySafe, std::max(0.25, 8.0 * convexity));
  }
  return report;
}

}  // namespace soft_robot_lab
