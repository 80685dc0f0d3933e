// SPDX-License-Identifier: BSD-3-Clause
#include "newton_solver.h"
#include "damped_bulk.h"
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
void tell_end(const Evaluation& here, double tolerance, std::string reason, NewtonReport& report) {
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
      terms_(tables_->terms),
      layout_(tables_->layout),
      pulled_n_(tables_->loads_n),
      loads_n_(tables_->loads_n),
      force_floor_n_(tables_->force_floor_n),
      contact_(tables_->contact),
      matrix_(tables_->matrix),
      factor_(tables_->factor),
      elements_(tables_->elements),
      springs_(elements_.batches(), elements_.slots()) {}

void NewtonSolver::pull(const Eigen::Matrix3Xd& forces_n) {
  pulled_n_ = tables_->loads_n + forces_n;
  loads_n_ = pulled_n_;
}

void NewtonSolver::add_loads(const Eigen::Matrix3Xd& extra_n) { loads_n_ = pulled_n_ + extra_n; }

void NewtonSolver::release(Eigen::Matrix3Xd& forces) const { forces.reshaped()(tables_->held).setZero(); }

Eigen::MatrixXd NewtonSolver::border(const NewtonState& state) const {
  Eigen::MatrixXd columns(state.positions_m.size(), constraint_count());
  Eigen::Matrix3Xd gradient(3, state.positions_m.cols());
  for (int i = 0; i < constraint_count(); ++i) {
    gradient.setZero();
    constraints_[i].add_gradient(state.positions_m, state.drives, 1.0, gradient);
    release(gradient);
    columns.col(i) = as_vector(gradient);
  }
  return columns;
}

NewtonSolver::Evaluation NewtonSolver::evaluate(const NewtonTask& task, const NewtonState& state) const {
  if (interrupt_) interrupt_->check();
  Evaluation result;
  result.residual_n = Eigen::Matrix3Xd::Zero(3, state.positions_m.cols());
  result.elements = elements_.add_gradient(state.positions_m, state.element_multipliers_pa, result.residual_n);
  double largest = std::max(force_floor_n_, std::max(result.residual_n.norm(), loads_n_.norm()));
  if (!terms_.empty()) largest = std::max(largest, add_terms(state, result));
  result.smooth_energy += result.elements.elastic_energy - loads_n_.cwiseProduct(state.positions_m).sum();
  if (task.inertia_per_s2 > 0.0) {
    const Eigen::Matrix3Xd lag = state.positions_m - *task.predicted_m;
    const Eigen::Matrix3Xd inertia = task.inertia_per_s2 * lag * body_.node_masses_kg().asDiagonal();
    result.smooth_energy += 0.5 * inertia.cwiseProduct(lag).sum();
    result.residual_n += inertia;
  }
  if (task.strain_target) {
    result.smooth_energy += springs_.add_gradient(state.positions_m, *task.strain_target, result.residual_n);
    if (task.strain_target->volume_ratio > 0.0) result.elements.volumetric_strain -= task.strain_target->free_volume();
  }
  result.residual_n -= loads_n_;

  double constraint_residual = 0.0;
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
    constraint_residual = std::max(constraint_residual, off);
  }
  for (int j = 0; j < friction_contact_count(); ++j)
    constraint_residual = std::max(
        constraint_residual,
        friction_violation(result.friction_contacts[j], state.constraint_multipliers, state.slips_m[j], force_floor_n_,
                           std::max(std::abs(result.values[result.friction_contacts[j].first]), 1e-300)));
  result.contact = contact_.sums(state.positions_m, state.contact);
  contact_.add_forces(result.contact, result.residual_n);
  release(result.residual_n);
  if (contact_.free().count() > 0) add_free_obstacles(state, result);
  const double volume_residual =
      elements_.mismatch(result.elements.volumetric_strain, state.element_multipliers_pa).cwiseAbs().maxCoeff();
  double residual_n = result.residual_n.norm();
  if (contact_.free().count() > 0) {
    largest = std::max(largest, contact_.free().weight_n());
    residual_n = std::hypot(residual_n, free_norm_n(contact_.free(), result.free_residual));
  }
  result.force_scale_n = largest;
  result.relative_residual =
      std::max({residual_n / largest, constraint_residual, volume_residual, result.contact.mismatch});
  result.finite =
      std::isfinite(residual_n) && std::isfinite(result.relative_residual) && std::isfinite(result.smooth_energy);
  return result;
}

// The size of all forces with theirs.
double NewtonSolver::add_terms(const NewtonState& state, Evaluation& result) const {
  result.smooth_energy += terms_.add_gradient(state.positions_m, state.drives, result.residual_n);
  return result.residual_n.norm();
}

void NewtonSolver::add_free_obstacles(const NewtonState& state, Evaluation& result) const {
  result.free_residual = contact_.free_forces_n(result.contact);
  result.smooth_energy +=
      add_free_gradient(contact_.free(), state.contact.free, state.free_inertia.get(), result.free_residual);
}

FreeColumns NewtonSolver::free_load(const Evaluation& here) const {
  FreeColumns load = -here.free_residual - contact_.free_mismatch_forces_n(touches_, here.contact);
  FreeColumns rigid = FreeColumns::Zero(3, load.cols());
  contact_.rigid().add_mismatch_forces(rigid_touches_, here.contact.rigid, rigid);
  return load - rigid;
}

// Where all that rubs is to stick, its ties pull without a limit.
void NewtonSolver::subtract_beyond(Eigen::VectorXd& load, FreeColumns& free_load) const {
  Eigen::Matrix3Xd beyond_n = Eigen::Matrix3Xd::Zero(3, load.size() / 3);
  FreeColumns free_n = FreeColumns::Zero(3, free_load.cols());
  contact_.add_beyond(touches_, beyond_n, free_n);
  contact_.rigid().add_beyond(rigid_touches_, free_n);
  release(beyond_n);
  load -= as_vector(beyond_n);
  free_load -= free_n;
}

// With what condensation of the contact pressures adds.
Eigen::VectorXd NewtonSolver::condensed_residual(const Evaluation& here, const Eigen::Matrix3Xd& residual_n) const {
  if (contact_.empty()) return as_vector(residual_n);
  Eigen::Matrix3Xd condensed_n = Eigen::Matrix3Xd::Zero(3, residual_n.cols());
  contact_.add_mismatch_forces(touches_, here.contact, !skin_in_border_, condensed_n);
  release(condensed_n);
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
    problem.delassus = delassus_;
    problem.excess = border_.transpose() * motion + delassus_ * state.constraint_multipliers;
    problem.laws = here.laws;
    problem.friction_contacts = here.friction_contacts;
    const double penalty = factor().negative_pivots() > 0 ? constants::kPenaltyOfBuckled : 1.0;
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
      before[count + static_cast<Eigen::Index>(k)] = contact_.push_n(step.skin[k]);
      laws.push_back(contact_.law_of(step.skin[k]));
    }
    add_skin(step.skin_columns, laws, border_solved_, motion, before, problem);
  }
  step.constraint_multipliers.resize(0);
  if (problem.laws.empty()) return factor().negative_pivots() == 0;
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
  const Eigen::VectorXd mismatch = elements_.mismatch(here.elements.volumetric_strain, state.element_multipliers_pa);
  load.gradient_n = Eigen::Matrix3Xd::Zero(3, state.positions_m.cols());
  elements_.add_mismatch_forces(mismatch, load.gradient_n);
  release(load.gradient_n);
  load.gradient_n += turned_back(turns_, here.residual_n);
  load.load_n = -condensed_residual(here, load.gradient_n);
  if (!free_border_.empty()) {
    load.free_n = free_load(here);
    subtract_beyond(load.load_n, load.free_n);
  }
  load.motion = skin_in_border_ ? solve_with(load.load_n, without_column(on_skin(here.contact))) : solve(load.load_n);
  if (!free_border_.empty()) load.motion += free_border_.nodal_motions(load.free_n.reshaped());
  return load;
}

bool NewtonSolver::find_step(const NewtonState& state, const Evaluation& here, const StepLoad& from,
                             const std::vector<ContactTouch>& ahead, Step& step) {
  step.contact_start = with_ahead(here.contact, ahead);
  step.skin = skin_in_border_ ? on_skin(step.contact_start) : std::vector<ContactTouch>();
  if (static_cast<int>(step.skin.size()) > kMostAhead) return false;
  step.skin_columns = columns_of(step.skin);
  if (!find_multipliers(state, here, from.motion, step)) return false;
  Eigen::VectorXd load = from.load_n, motion = from.motion;
  if (constraint_count() > 0) {
    motion -= border_solved_ * (step.constraint_multipliers - state.constraint_multipliers);
    if (!free_border_.empty()) load -= border_ * (step.constraint_multipliers - state.constraint_multipliers);
  }
  for (std::size_t k = 0; k < step.skin.size(); ++k)
    motion -= step.skin_changes_n[static_cast<Eigen::Index>(k)] * step.skin_columns[k]->solved;
  step.free_motion = free_border_.motion(from.free_n, load);
  if (!motion.allFinite()) return false;
  step.motion_m = Eigen::Map<const Eigen::Matrix3Xd>(motion.data(), 3, state.positions_m.cols());
  step.element_multipliers_pa = elements_.updated_multipliers(here.elements.volumetric_strain, step.motion_m);
  step.contact_pressures_pa =
      contact_.next_pressures_pa(touches_, here.contact, !skin_in_border_, step.motion_m, step.free_motion);
  for (std::size_t k = 0; k < step.skin.size(); ++k)
    step.contact_pressures_pa[step.skin[k].pair] =
        std::max(0.0, step.skin[k].pressure_pa +
                          contact_.pressure_pa(step.skin[k], step.skin_changes_n[static_cast<Eigen::Index>(k)]));
  if (!free_border_.empty())
    step.rigid_forces_n = contact_.rigid().next_forces_n(rigid_touches_, here.contact.rigid, step.free_motion);

  prepare_merit(state, here, from.gradient_n, step);
  step.motion_m = turned(turns_, step.motion_m);
  return std::isfinite(step.slope);
}

bool NewtonSolver::find_step(const NewtonState& state, const Evaluation& here, Step& step, int rounds) {
  const StepLoad load = step_load(state, here);
  std::vector<ContactTouch> ahead;
  for (int round = 0;; ++round) {
    if (!find_step(state, here, load, ahead, step)) return false;
    if (!skin_in_border_ || round == rounds) return true;
    ContactState there = state.contact;
    there.pressures_pa = step.contact_pressures_pa;
    const ContactSums end = contact_.sums(state.positions_m + step.motion_m, there);
    const std::vector<ContactTouch> more = contact_.met_by(step.motion_m, end, step.contact_start.touches);
    if (more.empty()) return true;
    ahead.insert(ahead.end(), more.begin(), more.end());
  }
}

// The factor may be of faces that points kept, which a saved state does not know.
void NewtonSolver::let_faces_go() {
  if (!contact_.skin().keeps_faces()) return;
  contact_.let_faces_go();
  forget_factor();
}

void NewtonSolver::abandon() {
  contact_.let_faces_go();
  forget_factor();
}

NewtonReport NewtonSolver::solve(const NewtonTask& task, NewtonState& state) {
  const DampedBulk damped(elements_, task.strain_target.get());
  NewtonReport report;
  Evaluation here = evaluate(task, state);
  if (!here.finite) {
    report.reason = "the starting state is not finite";
    report.residual = 1.0;
    return report;
  }
  const auto finish = [&](std::string reason) {
    tell_end(here, task.tolerance, std::move(reason), report);
    let_faces_go();
    end_ = {state.positions_m, state.element_multipliers_pa, std::move(here)};
    return report;
  };

  // Little but friction holds a free obstacle: by the tangent of what slips it would go far past where it sticks.
  const Slip cautious = contact_.free().count() > 0 ? Slip::secant : Slip::tangent;
  Slip slip = cautious;
  bool convex = false, old_factor = may_reuse(task, here.relative_residual);
  int secants = 0;
  AndersonMixing mixing(constants::kOldFactorSteps);
  const bool may_keep_faces = task.inertia_per_s2 > 0.0 && contact_.skin().pair_count() > 0;
  while (report.iterations < task.max_iterations) {
    if (report.iterations >= task.min_iterations && here.relative_residual <= task.tolerance) return finish("");
    if (may_keep_faces && report.iterations >= kFreeToChange) contact_.keep_faces(here.contact.touches);
    ++report.iterations;
    if (old_factor && mixing.size() < constants::kOldFactorSteps && try_old_factor(task, state, here, mixing)) continue;
    old_factor = false;
    mixing.clear();
    Step step;
    if (slip == Slip::secant && ++secants % constants::kSecants == 0) slip = Slip::stuck;
    if (slip == Slip::stuck) convex = false;
    const auto fresh_step = [&] {
      if (!convex && slip == Slip::tangent && has_factor_at(state, task.inertia_per_s2, task.strain_target))
        return find_step(state, here, step);
      ++report.factorisations;
      return linearise(state, task.inertia_per_s2, task.strain_target, convex, slip) && find_step(state, here, step);
    };
    const bool sticks = slip == Slip::stuck;
    bool found = fresh_step();
    if (!convex && (!found || step.slope > 0.0)) {
      if (task.only_through_stable) return finish("the way leads through an unstable shape");
      convex = true;
      slip = cautious;
      found = fresh_step();
    }
    if (convex) ++report.convexified;
    if (!found) return finish("the stiffness matrix could not be factorised");
    double length = 1.0;
    const bool accepted = search_line(task, step, state, here, length);
    if (length < 1.0) ++report.shortened;
    if (!accepted && convex) return finish("no step lowers the energy");
    convex = (!accepted && !sticks) || (convex && length < 1.0);
    if (convex && task.only_through_stable) return finish("no step lowers the energy");
    slip = convex || length < 1.0 ? cautious : Slip::tangent;
    old_factor = accepted && may_reuse(task, here.relative_residual) && !convex && slip == Slip::tangent;
  }
  return finish(here.relative_residual <= task.tolerance ? "" : "iteration limit");
}

double NewtonSolver::rest_residual(const NewtonState& state) const {
  const Evaluation here = evaluate(NewtonTask{}, state);
  return here.finite ? here.relative_residual : 1.0;
}

double NewtonSolver::come_closer(const NewtonTask& task, double most_m, NewtonState& state) {
  NewtonState at = state;
  double first_m = 0.0, before_m = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kCloser; ++i) {
    if (!has_factor_at(at, 0.0, nullptr) && !linearise(at, 0.0, nullptr, false)) break;
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
        part_before_obstacles(body_, contact_, at.positions_m, step.motion_m, at.contact) < 1.0)
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
