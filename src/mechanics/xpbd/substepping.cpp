// SPDX-License-Identifier: BSD-3-Clause
#include "substepping.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "mechanics/simulation/solve_ending.h"
#include "mechanics/solver_constants.h"

namespace soft_robot_lab {
namespace {

// The residual is that of a body at rest or of the last substep.
NewtonReport measure(SimulationParts& parts, const XpbdTask& task, const XpbdReport& done) {
  NewtonTask residual;
  residual.max_iterations = 0;
  residual.tolerance = parts.options.tolerance;
  residual.predicted_m = &done.predicted_m;
  residual.inertia_per_s2 = task.at_rest ? 0.0 : std::pow(done.substeps / task.time_step_s, 2);
  NewtonState measured = parts.unknowns();
  if (!task.at_rest) measured.free_inertia = done.free_inertia;
  NewtonReport found = parts.workspace.newton.solve(residual, measured);
  if (task.at_rest) return found;
  found.converged = done.stable;
  found.reason = done.stable ? "" : "the step created energy with " + std::to_string(done.substeps) + " substeps too";
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
  const XpbdReport done = parts.workspace.xpbd->advance_stably(task, moving);
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
  if (!advance_in_substeps(parts, task, before, report).finite) return;
  parts.state.time_s += task.time_step_s;
}

void settle_in_substeps(SimulationParts& parts, SolveReport& report) {
  const std::vector<double> from = parts.state.actuated_commands(), to = parts.state.commands();
  // What slips does so from here: no swing on the way is remembered.
  const Past start(parts.state);
  XpbdTask task = substepping(parts);
  task.at_rest = true;
  const double from_s = parts.state.contact.time_s,
               until_s = std::max(
                   {from_s, parts.workspace.newton.contact().end_of_motion_s(), parts.body.end_of_hold_motion_s()});
  double last_kinetic_energy = 0.0;
  for (int step = 1; step <= constants::kRelaxationSteps; ++step) {
    const Past before(parts.state);
    start.begin_slip(parts.state);
    const double way = std::min(1.0, static_cast<double>(step) / constants::kPullSteps);
    parts.place_actuators(from, to, way);
    move_by_itself(parts, from_s + way * (until_s - from_s), task);
    const XpbdReport done = advance_in_substeps(parts, task, before, report);
    if (!done.finite) break;
    if (done.kinetic_energy_j < last_kinetic_energy) stand_still(parts.state);
    last_kinetic_energy = done.kinetic_energy_j;
    if (report.converged && step >= constants::kPullSteps) break;
    if (step % constants::kRelaxationPatience == 0 && step <= 4 * constants::kRelaxationPatience)
      task.substep_count *= 2;
  }
  stand_still(parts.state);
  if (!report.converged)
    report.message = "not at rest after " + std::to_string(report.steps) + " time steps: " + report.message;
}

}  // namespace soft_robot_lab
