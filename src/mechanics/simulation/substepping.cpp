// SPDX-License-Identifier: BSD-3-Clause
#include "substepping.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>

#include "mechanics/linear_algebra/anderson_mixing.h"
#include "descent.h"
#include "equilibrium.h"
#include "rest_path.h"
#include "solve_ending.h"
#include "mechanics/solver_constants.h"

namespace soft_robot_lab {
namespace {

// Of the last substep; null without any.
std::shared_ptr<const StrainTarget> dashpots_of(const SimulationParts& parts, double substep_s,
                                                const Eigen::Matrix3Xd& started_m) {
  const double ratio = parts.body.viscosity().rayleigh_stiffness_s / substep_s;
  if (ratio == 0.0) return nullptr;
  const NewtonSolver& newton = parts.workspace.newton;
  return std::make_shared<const StrainTarget>(StrainTarget{2.0 * ratio * parts.body.material().lame_mu_pa(),
                                                           newton.energies().springs.strains(started_m), ratio,
                                                           newton.energies().sums_at(started_m).volumetric_strain});
}

// The residual is that of a body at rest or of the last substep.
NewtonReport measure(SimulationParts& parts, const XpbdTask& task, const XpbdReport& done) {
  NewtonTask residual;
  residual.max_iterations = 0;
  residual.tolerance = parts.options.tolerance;
  residual.predicted_m = &done.predicted_m;
  residual.inertia_per_s2 = task.at_rest ? 0.0 : std::pow(done.substeps / task.time_step_s, 2);
  NewtonState measured = parts.unknowns();
  if (!task.at_rest) {
    measured.free_inertia = done.free_inertia;
    residual.strain_target = dashpots_of(parts, task.time_step_s / done.substeps, done.started_m);
  }
  NewtonReport found = parts.workspace.newton.solve(residual, measured);
  if (task.at_rest) return found;
  const bool balanced = found.residual <= constants::kMostLeft;
  found.converged = done.stable && balanced && found.inverted_elements == 0;
  std::ostringstream reason;
  if (!done.stable) {
    reason << "the step created energy with " << done.substeps << " substeps too";
  } else if (!balanced) {
    reason << "the step left a residual of " << found.residual << ", out of range [0, " << constants::kMostLeft
           << "]; choose more solver.substeps than " << done.substeps;
  }
  found.reason = reason.str();
  return found;
}

// What a step that is undone must give back besides the shape.
struct Past {
  DriveStates drives;
  ContactState contact;

  explicit Past(const SimulationState& state) : drives(state.drives), contact(state.contact) {}
  // What slips does so from here.
  void begin_slip(SimulationState& state) const {
    state.drives = drives;
    state.contact.anchors_m = contact.anchors_m;
    state.contact.rigid_ties_m = contact.rigid_ties_m;
    state.contact.free_before = contact.free_before;
    state.contact.before_s = contact.before_s;
  }
};

// One time step of xpbd; kept only where it is finite.
XpbdReport advance_in_substeps(SimulationParts& parts, const XpbdTask& task, const Past& before, SolveReport& report) {
  const auto& made = parts.state.linearisation;
  XpbdState moving{parts.unknowns(),
                   parts.state.velocities_m_s,
                   parts.state.element_forces_n,
                   parts.state.branch_stress_pa,
                   made && !made->at ? std::static_pointer_cast<const KeptSolves>(made) : nullptr,
                   parts.state.free_velocities};
  XpbdSolver& solver = *parts.workspace.xpbd;
  const XpbdReport done = task.at_rest ? solver.advance(task, moving) : solver.advance_stably(task, moving);
  ++report.steps;
  report.iterations += done.sweeps;
  enter(SolveStage::xpbd, done.sweeps, report.path);
  report.rejected_steps += done.rejected_steps;
  NewtonReport found;
  if (done.finite) {
    parts.accept(std::move(moving.unknowns));
    parts.state.velocities_m_s = std::move(moving.velocities_m_s);
    parts.state.element_forces_n = std::move(moving.element_forces_n);
    parts.state.branch_stress_pa = std::move(moving.branch_stress_pa);
    parts.state.linearisation = std::move(moving.kept);
    parts.state.free_velocities = std::move(moving.free_velocities);
    found = measure(parts, task, done);
  } else {
    before.begin_slip(parts.state);
    found.residual = 1.0;
    found.reason = "the step went non-finite and was undone";
  }
  report_end(found, parts.body, report);
  return done;
}

// `until_s`: of what moves by itself.
void move_by_itself(const SimulationParts& parts, double until_s, XpbdTask& task) {
  task.until_s = until_s;
  task.reactions_n = nullptr;
  if (parts.body.holds_move_between(parts.state.contact.time_s, until_s))
    task.reactions_n = [&parts](const NewtonState& at) { return parts.workspace.newton.reaction_forces_n(at); };
}

XpbdTask substepping(const SimulationParts& parts) {
  XpbdTask task;
  task.time_step_s = parts.options.time_step_s;
  task.substep_count = parts.options.substep_count;
  task.iteration_count = parts.options.iteration_count;
  if (!parts.workspace.newton.contact().empty()) task.contact = &parts.workspace.newton.contact();
  move_by_itself(parts, parts.state.contact.time_s + task.time_step_s, task);
  return task;
}

// What a step towards rest maps to the next one.
Eigen::VectorXd numbers_of(const SimulationState& state) {
  Eigen::VectorXd all(state.positions_m.size() + state.element_forces_n.size() + state.element_multipliers_pa.size() +
                      state.constraint_multipliers.size());
  all << state.positions_m.reshaped(), state.element_forces_n, state.element_multipliers_pa,
      state.constraint_multipliers;
  return all;
}

void take_numbers(const Eigen::VectorXd& all, SimulationState& state) {
  Eigen::Index at = 0;
  const auto take = [&](auto& part) {
    part.reshaped() = all.segment(at, part.size());
    at += part.size();
  };
  take(state.positions_m);
  take(state.element_forces_n);
  take(state.element_multipliers_pa);
  take(state.constraint_multipliers);
}

// How a rest state is sought: long substeps lead there fast, but where an element bends away they lead nowhere.
struct RestPace {
  double substep_s = constants::kRestSubstep_s;
  AndersonMixing mixing{constants::kRestDepth};

  // False where they are as short as may be.
  bool slow_down() {
    if (substep_s <= constants::kLeastRestSubstep_s) return false;
    substep_s /= 2.0;
    steps_ = 0;
    mixing.clear();
    return true;
  }

  bool speed_up() {
    if (substep_s >= constants::kRestSubstep_s || ++steps_ < constants::kGoodRestSteps) return false;
    substep_s *= 2.0;
    steps_ = 0;
    mixing.clear();
    return true;
  }

  void mix(const Eigen::VectorXd& weights, const SimulationState& before, SimulationState& state) {
    Eigen::VectorXd at = numbers_of(before), step = numbers_of(state) - at;
    Eigen::VectorXd residual = weights.cwiseProduct(step.head(weights.size()));
    const double left = residual.norm();
    if (mixing.size() > 0 && left > constants::kMixedTooFar * left_) {
      mixing.clear();
      state = unmixed_;
      return;
    }
    left_ = left;
    unmixed_ = state;
    take_numbers(mixing.next(std::move(at), std::move(step), std::move(residual)), state);
  }

 private:
  int steps_ = 0;
  double left_ = 0.0;        // how far the last step went
  SimulationState unmixed_;  // where it ended
};

}  // namespace

void step_in_substeps(SimulationParts& parts, SolveReport& report) {
  const Past before(parts.state);
  const std::vector<double> from = parts.state.actuated_commands();
  parts.begin_step(parts.options.time_step_s);
  parts.advance_actuators(parts.options.time_step_s);
  const std::vector<double> to = parts.state.actuated_commands();
  XpbdTask task = substepping(parts);
  SubstepHysteresis hysteresis(parts.body, parts.workspace.newton.energies().springs);
  if (parts.body.viscosity().hysteresis_ratio > 0.0) task.hysteresis = &hysteresis;
  task.drives_at = [&](double fraction) {  // also a command without a speed limit takes the whole time step to arrive
    parts.place_actuators(from, to, fraction);
    return std::make_shared<const DriveStates>(parts.state.drives);
  };
  const ObstacleCuts cuts = parts_for_obstacles(parts.body, parts.workspace.newton.contact(), parts.state.positions_m,
                                                parts.state.velocities_m_s, parts.state.contact,
                                                parts.state.free_velocities, task.time_step_s);
  const int most = task.substep_count << constants::kDoublings;
  task.substep_count = std::max(task.substep_count, static_cast<int>(std::ceil(std::min<double>(cuts.parts, most))));
  const XpbdReport done = advance_in_substeps(parts, task, before, report);
  if (done.finite)
    report_overlap(overlap_at(parts.body, parts.workspace.newton.contact(), parts.state.contact), parts.body,
                   "; choose a shorter solver.time_step_s or more solver.substeps", report);
  report_fast_obstacle(cuts, most, parts.body, task.time_step_s, report);
  if (!done.finite) return;
  parts.state.time_s += task.time_step_s;
}

namespace {

// Of a body that nothing but its commands moves and that touches nothing. `start`: what slips does so from there, as
// nothing of the way is remembered.
void seek_rest(SimulationParts& parts, const Past& start, SolveReport& report) {
  const std::vector<double> from = parts.state.actuated_commands(), to = parts.state.commands();
  XpbdTask task = substepping(parts);
  task.at_rest = true;
  task.substep_count = constants::kRestSweeps;
  task.contact = nullptr;
  task.until_s = parts.state.contact.time_s;
  report.converged = false;
  RestPace pace;
  double reached = from != to ? 0.0 : 1.0, next = std::min(1.0, reached + 1.0 / constants::kPullSteps);
  while (report.steps < constants::kRestSteps) {
    const SimulationState before = parts.state;
    start.begin_slip(parts.state);
    task.time_step_s = pace.substep_s * task.substep_count;
    task.drives_at = [&](double fraction) {
      parts.place_actuators(from, to, reached + fraction * (next - reached));
      return std::make_shared<const DriveStates>(parts.state.drives);
    };
    const XpbdReport done = advance_in_substeps(parts, task, Past(before), report);
    if (!done.finite || done.last_motion > constants::kMostGrowth * done.first_motion) {
      parts.state = before;
      report.converged = false;
      if (!pace.slow_down()) break;
      continue;
    }
    reached = next;
    if (reached == 1.0 && report.converged) break;
    if (reached < 1.0 && report.residual < constants::kPullOn) {
      next = std::min(1.0, reached + 1.0 / constants::kPullSteps);
      pace.mixing.clear();
    } else if (!pace.speed_up()) {
      pace.mix(parts.workspace.xpbd->weights_at_rest(pace.substep_s), before, parts.state);
    }
  }
}

// Whether sweeps found the rest state: a stable one, on a way past nothing that it might have met. Newton's method
// takes the last bit of the way, as it does for what little holds.
bool sweeps_find_rest(SimulationParts& parts, const SimulationState& start, SolveReport& report) {
  if (parts.workspace.newton.contact().free().count() > 0 || RestPath(parts).something_moves()) return false;
  seek_rest(parts, Past(start), report);
  return report.converged && !may_have_met(parts, start) && relax(parts, report) == RestFound::stable;
}

}  // namespace

void settle_in_substeps(SimulationParts& parts, const EquilibriumOptions& options, SolveReport& report) {
  const SimulationState start = parts.state;
  if (!sweeps_find_rest(parts, start, report)) {
    parts.state = start;
    parts.state.linearisation.reset();
    report.warnings.clear();
    report.message.clear();
    report.converged = false;
    find_equilibrium(parts, options, report);
  }
  if (report.converged) parts.state.element_forces_n = parts.workspace.xpbd->forces_of(parts.unknowns());
  parts.state.linearisation.reset();
}

}  // namespace soft_robot_lab
