// SPDX-License-Identifier: BSD-3-Clause
// Steps by an old factor, which Anderson's mixing corrects.
#include <algorithm>
#include <limits>
#include <numeric>

#include "mechanics/contact/contact_step.h"
#include "mechanics/contact/swept_obstacles.h"
#include "mechanics/solver_constants.h"
#include "newton_solver.h"

namespace soft_robot_lab {
namespace {

constexpr int kFrozenStepsTried = 2;  // by an old factor, before its residual must have fallen
constexpr double kBearable = 3.0;     // times the residual: what the first of them may leave
constexpr int kHalves = 2;            // of a step by an old factor: the skin's forces turn more than its matrix knows

// From one state to another.
NewtonState halfway(const NewtonState& from, NewtonState to) {
  to.positions_m = 0.5 * (from.positions_m + to.positions_m);
  to.element_multipliers_pa = 0.5 * (from.element_multipliers_pa + to.element_multipliers_pa);
  to.constraint_multipliers = 0.5 * (from.constraint_multipliers + to.constraint_multipliers);
  to.slips_m = 0.5 * (from.slips_m + to.slips_m);
  to.contact.pressures_pa = 0.5 * (from.contact.pressures_pa + to.contact.pressures_pa);
  return to;
}

// Where a step presses: at some of what touches where it starts.
std::vector<Eigen::Index> pressed(const std::vector<ContactTouch>& start, const Eigen::VectorXd& pressures_pa) {
  std::vector<Eigen::Index> found;
  for (const ContactTouch& touch : start)
    if (pressures_pa[touch.pair] > 0.0) found.push_back(touch.pair);
  return found;
}

std::vector<Eigen::Index> all_of(const Eigen::VectorXd& pressures_pa) {
  std::vector<Eigen::Index> all(static_cast<std::size_t>(pressures_pa.size()));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

// Whether any point presses only before a step or only after it.
bool other_set(const std::vector<ContactTouch>& start, const Eigen::VectorXd& pressures_pa) {
  return std::any_of(start.begin(), start.end(), [&](const ContactTouch& touch) {
    return (touch.pressure_pa > 0.0) != (pressures_pa[touch.pair] > 0.0);
  });
}

}  // namespace

NewtonState NewtonSolver::full_step(const NewtonState& state, const Step& step) const {
  ContactState contact = system_.free_border().empty() ? state.contact : after(state, step, 1.0);
  contact.pressures_pa = step.contact_pressures_pa;
  return {state.positions_m + step.motion_m,
          step.element_multipliers_pa,
          step.constraint_multipliers,
          step.slips_m,
          state.drives,
          std::move(contact),
          state.free_inertia};
}

// The step of an old factor, corrected by what the last such steps have taught. All unknowns and residuals as one
// vector; the residuals as the convergence test takes them.
NewtonState NewtonSolver::mix(const NewtonState& state, const Evaluation& here, const Step& step,
                              AndersonMixing& mixing) const {
  ContactState contact = system_.free_border().empty() ? state.contact : after(state, step, 1.0);
  contact.pressures_pa = step.contact_pressures_pa;
  const bool other = system_.skin_in_border() && other_set(step.contact_start.touches, contact.pressures_pa);
  if (other) mixing.clear();
  if (other || friction_contact_count() > 0 ||
      energies_.contact.free().count() > 0)  // what presses, sticks and slips changes at once; no model of it is linear
    return full_step(state, step);
  // Of skin that is a constraint, only what presses; which of it does is the same meanwhile.
  const std::vector<Eigen::Index> pressing = system_.skin_in_border()
                                                 ? pressed(step.contact_start.touches, contact.pressures_pa)
                                                 : all_of(contact.pressures_pa);
  const Eigen::Index nodes = state.positions_m.size(), elements = state.element_multipliers_pa.size(),
                     constraints = state.constraint_multipliers.size(),
                     touching = static_cast<Eigen::Index>(pressing.size()), others = elements + constraints + touching;
  Eigen::VectorXd at(nodes + others), change(nodes + others), residual(nodes + others);
  at.head(nodes) = as_vector(state.positions_m);
  at.tail(others) << state.element_multipliers_pa, state.constraint_multipliers, state.contact.pressures_pa(pressing);
  change.head(nodes) = as_vector(step.motion_m);
  change.tail(others) << step.element_multipliers_pa - state.element_multipliers_pa,
      step.constraint_multipliers - state.constraint_multipliers,
      contact.pressures_pa(pressing) - state.contact.pressures_pa(pressing);
  residual.head(nodes) = as_vector(here.residual_n) / here.force_scale_n;
  residual.tail(others) << energies_.elements.mismatch(here.elements.volumetric_strain, state.element_multipliers_pa),
      Eigen::VectorXd(constraints), mismatches(energies_.contact, here.contact, pressing);
  for (int i = 0; i < constraint_count(); ++i)
    residual[nodes + elements + i] = relative_violation(here.laws[i], state.constraint_multipliers[i], here.values[i]);
  const bool first = mixing.size() == 0;
  const Eigen::VectorXd next = mixing.next(std::move(at), std::move(change), std::move(residual));
  const double least_pa =
      system_.skin_in_border() ? std::numeric_limits<double>::min() : 0.0;  // what presses goes on to
  if (!first || !system_.skin_in_border()) contact.pressures_pa(pressing) = next.tail(touching).cwiseMax(least_pa);
  NewtonState mixed{Eigen::Map<const Eigen::Matrix3Xd>(next.data(), 3, state.positions_m.cols()),
                    next.segment(nodes, elements),
                    next.segment(nodes + elements, constraints),
                    state.slips_m,
                    state.drives,
                    std::move(contact)};
  for (int i = 0; i < constraint_count(); ++i)
    mixed.constraint_multipliers[i] =
        std::clamp(mixed.constraint_multipliers[i], here.laws[i].min_multiplier, here.laws[i].max_multiplier);
  return mixed;
}

// A step by the last factor, kept only where it brings the residual down; where it does not, but by little, one more
// from there, as the forces' norm need not fall where the shape comes nearer. Volume and constraint multipliers stay
// unknowns of their own, so it converges as fast as the body has turned little, however incompressible it is.
bool NewtonSolver::try_frozen_factor(const NewtonTask& task, NewtonState& state, Evaluation& here,
                                     AndersonMixing& mixing) {
  if (!system_.may_serve(task.inertia_per_s2, task.strain_target != nullptr, here.contact)) return false;
  if (mixing.size() == 0) system_.turn_to(state.positions_m, here.contact.touches);
  const double enough = std::max(task.tolerance, constants::kWorthwhileDecrease * here.relative_residual);
  NewtonState reached;
  Evaluation at_reached;
  for (int tried = 0; tried < kFrozenStepsTried; ++tried) {
    const NewtonState& from = tried == 0 ? state : reached;
    const Evaluation& at_from = tried == 0 ? here : at_reached;
    Step step;
    if (!find_step(from, at_from, step, mixing.size() == 0 ? kRoundsAhead : 0)) return false;
    NewtonState trial = mix(from, at_from, step, mixing);
    const Eigen::Matrix3Xd way_m = trial.positions_m - from.positions_m;
    if (part_before_contact(body_, energies_.contact, from.positions_m, way_m, from.contact) < 1.0) return false;
    Evaluation there = evaluate(task, trial);
    const auto falls = [&] { return there.finite && there.relative_residual <= enough; };
    for (int half = 0; half < kHalves && !step.skin.empty() && !falls(); ++half) {
      trial = halfway(from, std::move(trial));
      there = evaluate(task, trial);
    }
    if (falls()) {
      state = std::move(trial);
      here = std::move(there);
      return true;
    }
    const bool bearable = there.finite && there.relative_residual <= kBearable * here.relative_residual;
    if (!bearable || !step.skin.empty() || mixing.size() >= constants::kFrozenFactorSteps) return false;
    reached = std::move(trial);
    at_reached = std::move(there);
  }
  return false;
}

}  // namespace soft_robot_lab
