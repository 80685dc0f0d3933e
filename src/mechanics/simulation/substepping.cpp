// SPDX-License-Identifier: BSD-3-Clause
#include "substepping.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>

#include "mechanics/linear_algebra/anderson_mixing.h"
#include "descent.h"
#include "solve_ending.h"
#include "mechanics/solver_constants.h"

namespace soft_robot_lab {
namespace {

constexpr int kMostSaddles = 4;  // on the way to one rest state

// Of the last substep; null without any.
std::shared_ptr<const StrainTarget> dashpots_of(const SimulationParts& parts, double substep_s,
                                                const Eigen::Matrix3Xd& started_m) {
  const double ratio = parts.body.viscosity().rayleigh_stiffness_s / substep_s;
  if (ratio == 0.0) return nullptr;
  const NewtonSolver& newton = parts.workspace.newton;
  return std::make_shared<const StrainTarget>(StrainTarget{2.0 * ratio * parts.body.material().lame_mu_pa(),
                                                           newton.strains(started_m), ratio,
                                                           newton.volumetric_strain(started_m)});
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

void stand_still(SimulationState& state) {
  state.velocities_m_s.setZero();
  state.free_velocities.linear_m_s.setZero();
  state.free_velocities.angular_rad_s.setZero();
}

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
  tell_end(found, parts.body, report);
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

// A body that rests is set in motion by what comes to touch it: below that this is no growth.
double unseen_motion(const SimulationParts& parts, double substep_s) {
  const Eigen::VectorXd weights = parts.workspace.xpbd->weights_at_rest(substep_s);
  return weights.head(parts.state.positions_m.size()).norm() * constants::kUnseenMotion * parts.body.size_m() /
         substep_s;
}

// What a step towards rest maps to the next one, but for the turns of free obstacles.
Eigen::VectorXd numbers_of(const SimulationState& state) {
  Eigen::VectorXd all(state.positions_m.size() + state.element_forces_n.size() + state.element_multipliers_pa.size() +
                      state.constraint_multipliers.size() + state.contact.pressures_pa.size() +
                      state.contact.rigid_forces_n.size() + state.contact.free.centers_m.size());
  all << state.positions_m.reshaped(), state.element_forces_n, state.element_multipliers_pa,
      state.constraint_multipliers, state.contact.pressures_pa, state.contact.rigid_forces_n,
      state.contact.free.centers_m.reshaped();
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
  take(state.contact.pressures_pa);
  take(state.contact.rigid_forces_n);
  take(state.contact.free.centers_m);
  state.contact.pressures_pa = state.contact.pressures_pa.cwiseMax(0.0);
  state.contact.rigid_forces_n = state.contact.rigid_forces_n.cwiseMax(0.0);
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
  SubstepHysteresis hysteresis(parts.body, parts.workspace.newton.springs());
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
  report_fast_obstacle(cuts, most, parts.body, task.time_step_s, report);
  if (!done.finite) return;
  parts.state.time_s += task.time_step_s;
}

namespace {

// `start`: what slips does so from there, as nothing of the way is remembered.
void seek_rest(SimulationParts& parts, const Past& start, SolveReport& report) {
  const std::vector<double> from = parts.state.actuated_commands(), to = parts.state.commands();
  const double from_s = parts.state.contact.time_s,
               until_s = std::max(
                   {from_s, parts.workspace.newton.contact().end_of_motion_s(), parts.body.end_of_hold_motion_s()});
  XpbdTask task = substepping(parts);
  task.at_rest = true;
  task.substep_count = constants::kRestSweeps;
  stand_still(parts.state);
  report.converged = false;
  RestPace pace;
  // Of the way of what is moved.
  double reached = from != to || until_s > from_s ? 0.0 : 1.0,
         next = std::min(1.0, reached + 1.0 / constants::kPullSteps);
  while (report.steps < constants::kRestSteps) {
    const SimulationState before = parts.state;
    start.begin_slip(parts.state);
    task.time_step_s = pace.substep_s * task.substep_count;
    task.drives_at = [&](double fraction) {
      parts.place_actuators(from, to, reached + fraction * (next - reached));
      return std::make_shared<const DriveStates>(parts.state.drives);
    };
    move_by_itself(parts, from_s + next * (until_s - from_s), task);
    const XpbdReport done = advance_in_substeps(parts, task, Past(before), report);
    const double unseen = reached < 1.0 ? unseen_motion(parts, pace.substep_s) : 0.0;
    const bool grows = done.last_motion > std::max(unseen, constants::kMostGrowth * done.first_motion);
    if (!done.finite || grows) {
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
  parts.state.linearisation.reset();
  if (!report.converged)
    report.message = "not at rest after " + std::to_string(report.steps) + " steps: " + report.message;
}

// Off a shape that is no minimum of the energy, to which `way_m` has led, and on to rest; a report without convergence
// where no way leads off it. Sweeps leave a saddle slowly, and Anderson's mixing leads back to it as Newton's method
// would, so the continuation of `newton` goes down from there.
void leave_saddle(SimulationParts& parts, const Past& start, const Eigen::Matrix3Xd& way_m, SolveReport& report) {
  SimulationState& state = parts.state;
  const Eigen::Matrix3Xd saddle_m = state.positions_m;
  const Nudge nudge = nudge_off(parts, way_m);
  report.converged = false;
  if (nudge.motion_m.cols() == 0) return;
  state.positions_m += nudge.motion_m;
  if (!descend(parts, report, Ballooning(parts))) return;
  state.linearisation.reset();
  state.element_forces_n = parts.workspace.xpbd->forces_of(parts.unknowns());
  seek_rest(parts, start, report);
  const Snap snap = snap_between(saddle_m, state.positions_m, 1.0, nudge.other_side, parts.body);
  if (report.converged && snap.moved_m > kLeastSnap * parts.body.size_m()) note_snap(snap, report);
}

}  // namespace

void settle_in_substeps(SimulationParts& parts, SolveReport& report) {
  const SimulationState before = parts.state;
  const Past start(before);
  seek_rest(parts, start, report);
  for (int left = 0; report.converged && !is_minimum(parts, parts.unknowns()); ++left) {
    if (left == kMostSaddles) {
      report.converged = false;
      report.message = "the shape that was found is unstable";
    } else {
      leave_saddle(parts, start, parts.state.positions_m - before.positions_m, report);
      if (!report.converged) report.message = "no stable shape beside an unstable one: " + report.message;
    }
  }
  if (!report.converged) parts.state = before;
}

}  // namespace soft_robot_lab
