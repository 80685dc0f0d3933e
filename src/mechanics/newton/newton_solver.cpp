// SPDX-License-Identifier: BSD-3-Clause
#include "newton_solver.h"
#include "damped_bulk.h"
#include "mechanics/contact/contact_step.h"
#include "mechanics/contact/swept_obstacles.h"
#include "mechanics/solver_constants.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include <Eigen/LU>

namespace soft_robot_lab {
namespace {

template <class Evaluation>
void report_end(const Evaluation& here, double tolerance, std::string reason, NewtonReport& report) {
  report.residual = here.relative_residual;
  report.inverted_elements = here.elements.inverted;
  report.worst_element = here.elements.worst_element;
  report.smallest_determinant = here.elements.smallest_determinant;
  report.tolerance = tolerance;
  here.residual_n.colwise().squaredNorm().maxCoeff(&report.worst_node);
  report.converged = reason.empty();
  report.reason = std::move(reason);
}

// The last factor, for the next step of a solve with this residual.
bool may_reuse(const NewtonTask& task, double residual) { return task.reuse_factor || residual < task.reuse_below; }

// Iterations of a time step after which a point of skin keeps the face that it meets: over a corner it might change it
// in each, and the step would have no end.
constexpr int kFreeToChange = 8;

constexpr int kCloser = 6;            // steps
constexpr double kDifference = 1e-6;  // of the body's size: a way over which a stiffness is measured

std::vector<ContactTouch> on_skin(const ContactSums& contact) {
  std::vector<ContactTouch> found;
  std::copy_if(contact.touches.begin(), contact.touches.end(), std::back_inserter(found),
               [](const ContactTouch& touch) { return touch.on_skin(); });
  return found;
}

ContactSums with_ahead(ContactSums contact, const std::vector<ContactTouch>& ahead) {
  if (ahead.empty()) return contact;
  contact.touches.insert(contact.touches.end(), ahead.begin(), ahead.end());
  std::sort(contact.touches.begin(), contact.touches.end(),
            [](const ContactTouch& a, const ContactTouch& b) { return a.pair < b.pair; });
  return contact;
}

}  // namespace

NewtonSolver::NewtonSolver(std::shared_ptr<const NewtonTables> tables)
    : tables_(std::move(tables)),
      body_(tables_->body),
      constraints_(tables_->constraints),
      shared_(tables_->shared),
      energies_(*tables_),
      system_(*tables_, energies_) {}

void NewtonSolver::heed(const Interrupt* interrupt) {
  interrupt_ = interrupt;
  system_.heed(interrupt);
}

NewtonSolver::Evaluation NewtonSolver::evaluate(const NewtonTask& task, const NewtonState& state) const {
  if (interrupt_) interrupt_->check();
  Evaluation result;
  result.residual_n = Eigen::Matrix3Xd::Zero(3, state.positions_m.cols());
  result.elements = energies_.elements.add_gradient(state.positions_m, state.element_multipliers_pa, result.residual_n);
  double largest = std::max(tables_->force_floor_n, std::max(result.residual_n.norm(), energies_.loads.all_n().norm()));
  if (!energies_.terms.empty()) {
    result.smooth_energy += energies_.terms.add_gradient(state.positions_m, state.drives, result.residual_n);
    largest = std::max(largest, result.residual_n.norm());
  }
  result.smooth_energy +=
      result.elements.elastic_energy - energies_.loads.all_n().cwiseProduct(state.positions_m).sum();
  if (task.inertia_per_s2 > 0.0) {
    const Eigen::Matrix3Xd lag = state.positions_m - *task.predicted_m;
    const Eigen::Matrix3Xd inertia = task.inertia_per_s2 * lag * body_.node_masses_kg().asDiagonal();
    result.smooth_energy += 0.5 * inertia.cwiseProduct(lag).sum();
    result.residual_n += inertia;
  }
  if (task.strain_target) {
    result.smooth_energy += energies_.springs.add_gradient(state.positions_m, *task.strain_target, result.residual_n);
    if (task.strain_target->volume_ratio > 0.0) result.elements.volumetric_strain -= task.strain_target->free_volume();
  }
  result.residual_n -= energies_.loads.all_n();

  const double constraint_residual = add_constraints(state, result);
  result.contact = energies_.contact.sums(state.positions_m, state.contact);
  energies_.contact.add_forces(result.contact, result.residual_n);
  tables_->release(result.residual_n);
  const double free_residual = energies_.contact.free().count() > 0 ? add_free_obstacles(state, result) : 0.0;
  const double volume_residual =
      energies_.elements.mismatch(result.elements.volumetric_strain, state.element_multipliers_pa)
          .cwiseAbs()
          .maxCoeff();
  double residual_n = result.residual_n.norm();
  if (energies_.contact.free().count() > 0) {
    largest = std::max(largest, energies_.contact.free().weight_n());
    residual_n = std::hypot(residual_n, free_norm_n(energies_.contact.free(), result.free_residual));
  }
  result.force_scale_n = largest;
  result.relative_residual =
      std::max({residual_n / largest, constraint_residual, volume_residual, result.contact.mismatch, free_residual});
  result.finite =
      std::isfinite(residual_n) && std::isfinite(result.relative_residual) && std::isfinite(result.smooth_energy);
  return result;
}

double NewtonSolver::add_constraints(const NewtonState& state, Evaluation& result) const {
  double residual = 0.0;
  result.friction_contacts = junctions_at(state.positions_m);
  for (int i = 0; i < constraint_count(); ++i) {
    const double y = state.constraint_multipliers[i];
    result.values.push_back(constraints_[i].value(state.positions_m, state.drives));
    result.laws.push_back(constraints_[i].law(result.values.back(), y, state.drives));
    if (y != 0.0) constraints_[i].add_gradient(state.positions_m, state.drives, y, result.residual_n);
  }
  const std::vector<ConstraintLaw> laws = after_flows(result.laws, result.friction_contacts, state.slips_m);
  for (int i = 0; i < constraint_count(); ++i) {
    const double y = state.constraint_multipliers[i];
    const ConstraintLaw& law = laws[i];
    // A prescribed multiplier is met or not.
    const double off = law.prescribed() ? (std::abs(y - law.min_multiplier) > 1e-12 * std::abs(y) ? 1.0 : 0.0)
                                        : std::abs(relative_violation(law, y, result.values[i]));
    residual = std::max(residual, off);
  }
  for (int j = 0; j < friction_contact_count(); ++j)
    residual = std::max(
        residual, friction_violation(result.friction_contacts[j], state.constraint_multipliers, state.slips_m[j],
                                     tables_->force_floor_n,
                                     std::max(std::abs(result.values[result.friction_contacts[j].first]), 1e-300)));
  return residual;
}

double NewtonSolver::add_free_obstacles(const NewtonState& state, Evaluation& result) const {
  const FreeObstacles& free = energies_.contact.free();
  const FreeColumns contact_n = energies_.contact.free_forces_n(result.contact);
  result.free_residual = contact_n;
  result.smooth_energy += add_free_gradient(free, state.contact.free, state.free_inertia.get(), result.free_residual);
  return free_imbalance(free, contact_n, result.free_residual, state.free_inertia.get());
}

FreeColumns NewtonSolver::free_load(const Evaluation& here) const {
  FreeColumns load = -here.free_residual - free_mismatch_forces_n(energies_.contact, system_.touches(), here.contact);
  FreeColumns rigid = FreeColumns::Zero(3, load.cols());
  energies_.contact.rigid().add_mismatch_forces(system_.rigid_touches(), here.contact.rigid, rigid);
  return load - rigid;
}

// Where all that rubs is to stick, its ties pull without a limit.
void NewtonSolver::subtract_beyond(Eigen::VectorXd& load, FreeColumns& free_load) const {
  Eigen::Matrix3Xd beyond_n = Eigen::Matrix3Xd::Zero(3, load.size() / 3);
  FreeColumns free_n = FreeColumns::Zero(3, free_load.cols());
  add_beyond(energies_.contact, system_.touches(), beyond_n, free_n);
  energies_.contact.rigid().add_beyond(system_.rigid_touches(), free_n);
  tables_->release(beyond_n);
  load -= as_vector(beyond_n);
  free_load -= free_n;
}

// With what condensation of the contact pressures adds.
Eigen::VectorXd NewtonSolver::condensed_residual(const Evaluation& here, const Eigen::Matrix3Xd& residual_n) const {
  if (energies_.contact.empty()) return as_vector(residual_n);
  Eigen::Matrix3Xd condensed_n = Eigen::Matrix3Xd::Zero(3, residual_n.cols());
  add_mismatch_forces(energies_.contact, system_.touches(), here.contact, !system_.skin_in_border(), condensed_n);
  tables_->release(condensed_n);
  return as_vector(residual_n) + as_vector(condensed_n);
}

// The multipliers where a step leads. `motion`: without any change of them.
bool NewtonSolver::find_multipliers(const NewtonState& state, const Evaluation& here, const Eigen::VectorXd& motion,
                                    Step& step) const {
  const int count = constraint_count();
  const auto touching = static_cast<Eigen::Index>(step.skin.size());
  step.penalties.resize(count);
  step.slips_m.resize(friction_contact_count());
  MultiplierProblem problem;
  Eigen::VectorXd before = state.constraint_multipliers;
  if (count > 0) {
    problem.delassus = system_.border().delassus;
    problem.excess =
        system_.border().columns.transpose() * motion + system_.border().delassus * state.constraint_multipliers;
    problem.laws = here.laws;
    problem.friction_contacts = here.friction_contacts;
    const double penalty = system_.negative_pivots() > 0 ? constants::kPenaltyOfBuckled : 1.0;
    for (int i = 0; i < count; ++i) {
      step.penalties[i] = penalty / std::max(std::abs(problem.delassus(i, i)) + here.laws[i].compliance, 1e-300);
      problem.delassus(i, i) += here.laws[i].compliance;
      problem.excess[i] += here.laws[i].offset;
    }
  }
  if (touching > 0) {
    std::vector<ConstraintLaw> laws;
    before.conservativeResize(count + touching);
    for (std::size_t k = 0; k < step.skin.size(); ++k) {
      before[count + static_cast<Eigen::Index>(k)] = push_n(energies_.contact, step.skin[k]);
      laws.push_back(law_of(energies_.contact, step.skin[k]));
    }
    add_skin(step.skin_columns, laws, system_.border().solved, motion, before, problem);
  }
  step.constraint_multipliers.resize(0);
  if (problem.laws.empty()) return system_.negative_pivots() == 0;
  Multipliers solved = solve_multipliers(problem, before);
  if (!solved.found) return false;
  if (friction_contact_count() > 0) step.slips_m = std::move(solved.slips_m);
  step.skin_changes_n = (solved.y - before).tail(touching);
  step.constraint_multipliers = solved.y.head(count);
  return stable_under(problem, solved.y);
}

// The residual holds the forces of the old multipliers already, so the border answers only for their change.
NewtonSolver::StepLoad NewtonSolver::step_load(const NewtonState& state, const Evaluation& here) {
  StepLoad load;
  const Eigen::VectorXd mismatch =
      energies_.elements.mismatch(here.elements.volumetric_strain, state.element_multipliers_pa);
  load.gradient_n = Eigen::Matrix3Xd::Zero(3, state.positions_m.cols());
  energies_.elements.add_mismatch_forces(mismatch, load.gradient_n);
  tables_->release(load.gradient_n);
  load.gradient_n += turned_back(system_.turns(), here.residual_n);
  load.load_n = -condensed_residual(here, load.gradient_n);
  if (!system_.free_border().empty()) {
    load.free_n = free_load(here);
    subtract_beyond(load.load_n, load.free_n);
  }
  load.motion =
      system_.skin_in_border() ? system_.solve_with(load.load_n, on_skin(here.contact)) : system_.solve(load.load_n);
  if (!system_.free_border().empty()) load.motion += system_.free_border().nodal_motions(load.free_n.reshaped());
  return load;
}

bool NewtonSolver::find_step(const NewtonState& state, const Evaluation& here, const StepLoad& from,
                             const std::vector<ContactTouch>& ahead, Step& step) {
  step.contact_start = with_ahead(here.contact, ahead);
  step.skin = system_.skin_in_border() ? on_skin(step.contact_start) : std::vector<ContactTouch>();
  if (static_cast<int>(step.skin.size()) > kMostAhead) return false;
  step.skin_columns = system_.columns_of(step.skin);
  if (!find_multipliers(state, here, from.motion, step)) return false;
  Eigen::VectorXd load = from.load_n, motion = from.motion;
  if (constraint_count() > 0) {
    motion -= system_.border().solved * (step.constraint_multipliers - state.constraint_multipliers);
    if (!system_.free_border().empty())
      load -= system_.border().columns * (step.constraint_multipliers - state.constraint_multipliers);
  }
  for (std::size_t k = 0; k < step.skin.size(); ++k)
    motion -= step.skin_changes_n[static_cast<Eigen::Index>(k)] * step.skin_columns[k]->solved;
  step.free_motion = system_.free_border().motion(from.free_n, load);
  if (!motion.allFinite()) return false;
  step.motion_m = Eigen::Map<const Eigen::Matrix3Xd>(motion.data(), 3, state.positions_m.cols());
  step.element_multipliers_pa = energies_.elements.updated_multipliers(here.elements.volumetric_strain, step.motion_m);
  step.contact_pressures_pa = next_pressures_pa(energies_.contact, system_.touches(), here.contact,
                                                !system_.skin_in_border(), step.motion_m, step.free_motion);
  for (std::size_t k = 0; k < step.skin.size(); ++k)
    step.contact_pressures_pa[step.skin[k].pair] =
        std::max(0.0, step.skin[k].pressure_pa + step.skin_changes_n[static_cast<Eigen::Index>(k)] /
                                                     energies_.contact.weight_m2(step.skin[k].pair));
  if (!system_.free_border().empty())
    step.rigid_forces_n =
        energies_.contact.rigid().next_forces_n(system_.rigid_touches(), here.contact.rigid, step.free_motion);

  prepare_merit(state, here, from.gradient_n, step);
  step.motion_m = turned(system_.turns(), step.motion_m);
  return std::isfinite(step.slope);
}

bool NewtonSolver::find_step(const NewtonState& state, const Evaluation& here, Step& step, int rounds) {
  const StepLoad load = step_load(state, here);
  std::vector<ContactTouch> ahead;
  for (int round = 0;; ++round) {
    if (!find_step(state, here, load, ahead, step)) return false;
    if (!system_.skin_in_border() || round == rounds) return true;
    ContactState there = state.contact;
    there.pressures_pa = step.contact_pressures_pa;
    const ContactSums end = energies_.contact.sums(state.positions_m + step.motion_m, there);
    const std::vector<ContactTouch> more = met_by(energies_.contact, step.motion_m, end, step.contact_start.touches);
    if (more.empty()) return true;
    ahead.insert(ahead.end(), more.begin(), more.end());
  }
}

// The factor may be of faces that points kept, which a saved state does not know.
void NewtonSolver::let_faces_go() {
  if (!energies_.contact.skin().keeps_faces()) return;
  energies_.contact.skin().let_faces_go();
  system_.forget_factor();
}

void NewtonSolver::abandon() {
  energies_.contact.skin().let_faces_go();
  system_.forget_factor();
}

NewtonReport NewtonSolver::solve(const NewtonTask& task, NewtonState& state) {
  const DampedBulk damped(energies_.elements, task.strain_target.get());
  NewtonReport report;
  Evaluation here = evaluate(task, state);
  if (!here.finite) {
    report.reason = "the starting state is not finite";
    report.residual = 1.0;
    return report;
  }
  const auto finish = [&](std::string reason) {
    report_end(here, task.tolerance, std::move(reason), report);
    let_faces_go();
    end_ = {state.positions_m, state.element_multipliers_pa, std::move(here)};
    return report;
  };

  // Little but friction holds a free obstacle: by the tangent of what slips it would go far past where it sticks.
  const Slip cautious = energies_.contact.free().count() > 0 ? Slip::secant : Slip::tangent;
  StepPolicy policy{cautious, cautious, may_reuse(task, here.relative_residual)};
  AndersonMixing mixing(constants::kFrozenFactorSteps);
  const bool may_keep_faces = task.inertia_per_s2 > 0.0 && energies_.contact.skin().pair_count() > 0;
  while (report.iterations < task.max_iterations) {
    if (report.iterations >= task.min_iterations && here.relative_residual <= task.tolerance) return finish("");
    if (may_keep_faces && report.iterations >= kFreeToChange) energies_.contact.skin().keep_faces(here.contact.touches);
    ++report.iterations;
    const bool try_old = policy.frozen_factor && mixing.size() < constants::kFrozenFactorSteps;
    if (try_old && try_frozen_factor(task, state, here, mixing)) continue;
    mixing.clear();
    std::string why_not = take_fresh_step(task, policy, state, here, report);
    if (!why_not.empty()) return finish(std::move(why_not));
  }
  return finish(here.relative_residual <= task.tolerance ? "" : "iteration limit");
}

bool NewtonSolver::find_fresh_step(const NewtonTask& task, const StepPolicy& policy, const NewtonState& state,
                                   const Evaluation& here, Step& step, NewtonReport& report) {
  if (policy.plain() && system_.has_factor_at(state, task.inertia_per_s2, task.strain_target))
    return find_step(state, here, step);
  ++report.factorisations;
  return system_.linearise(state, task.inertia_per_s2, task.strain_target, policy.convex, policy.slip) &&
         find_step(state, here, step);
}

void NewtonSolver::StepPolicy::follow(bool accepted, bool stuck, bool shortened) {
  convex = (!accepted && !stuck) || (convex && shortened);
  slip = convex || shortened ? cautious : Slip::tangent;
}

std::string NewtonSolver::take_fresh_step(const NewtonTask& task, StepPolicy& policy, NewtonState& state,
                                          Evaluation& here, NewtonReport& report) {
  if (policy.slip == Slip::secant && ++policy.secants % constants::kSecants == 0) policy.slip = Slip::stuck;
  const bool sticks = policy.slip == Slip::stuck;
  if (sticks) policy.convex = false;
  Step step;
  bool found = find_fresh_step(task, policy, state, here, step, report);
  if (!policy.convex && (!found || step.slope > 0.0)) {
    if (task.only_through_stable) return "the way leads through an unstable shape";
    policy.convex = true;
    policy.slip = policy.cautious;
    found = find_fresh_step(task, policy, state, here, step, report);
  }
  if (policy.convex) ++report.convexified;
  if (!found) return "the stiffness matrix could not be factorised";
  double length = 1.0;
  const bool accepted = search_line(task, step, state, here, length);
  if (length < 1.0) ++report.shortened;
  if (!accepted && policy.convex) return "no step lowers the energy";
  policy.follow(accepted, sticks, length < 1.0);
  if (policy.convex && task.only_through_stable) return "no step lowers the energy";
  policy.frozen_factor = accepted && policy.plain() && may_reuse(task, here.relative_residual);
  return "";
}

double NewtonSolver::rest_residual(const NewtonState& state) const {
  const Evaluation here = evaluate(NewtonTask{}, state);
  return here.finite ? here.relative_residual : 1.0;
}

double NewtonSolver::come_closer(const NewtonTask& task, double most_m, NewtonState& state) {
  NewtonState at = state;
  double first_m = 0.0, before_m = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kCloser; ++i) {
    if (!system_.has_factor_at(at, 0.0, nullptr) && !system_.linearise(at, 0.0, nullptr, false)) break;
    const Evaluation here = evaluate(task, at);
    Step step;
    if (!here.finite || !find_step(at, here, step)) break;
    const double left_m = step.motion_m.colwise().norm().maxCoeff();
    if (i == 0) first_m = left_m;
    if (left_m <= most_m && here.relative_residual <= task.tolerance) {
      state = std::move(at);
      return left_m;
    }
    if (left_m > 0.5 * before_m ||
        part_before_contact(body_, energies_.contact, at.positions_m, step.motion_m, at.contact) < 1.0)
      break;
    before_m = left_m;
    at = full_step(at, step);
  }
  return first_m;
}

double NewtonSolver::creep_left_m(const NewtonState& state, const Eigen::Matrix3Xd& velocities_m_s) const {
  const double speed_m_s = velocities_m_s.colwise().norm().maxCoeff();
  if (speed_m_s == 0.0) return 0.0;
  const Eigen::Matrix3Xd along = velocities_m_s / speed_m_s;
  const auto force_n = [&](double way_m) {
    NewtonState there = state;
    there.positions_m += way_m * along;
    return residual_n(there).cwiseProduct(along).sum();
  };
  const double small_m = kDifference * body_.size_m();
  const double stiffness_n_m = (force_n(small_m) - force_n(-small_m)) / (2.0 * small_m);
  return std::abs(force_n(0.0) / stiffness_n_m);
}

double NewtonSolver::worst_violation(const NewtonState& state) const {
  double worst = 0.0;
  for (int i = 0; i < constraint_count(); ++i) {
    const double value = constraints_[i].value(state.positions_m, state.drives);
    const ConstraintLaw law = constraints_[i].law(value, state.constraint_multipliers[i], state.drives);
    worst = std::max(worst, std::abs(relative_violation(law, state.constraint_multipliers[i], value)));
  }
  return worst;
}

std::vector<FrictionContactBound> NewtonSolver::junctions_at(const Eigen::Matrix3Xd& positions_m) const {
  std::vector<FrictionContactBound> bounds;
  for (const SharedLength& shared : shared_)
    bounds.push_back({shared.first, shared.second, shared.contact->ratio(positions_m)});
  return bounds;
}

}  // namespace soft_robot_lab
