// SPDX-License-Identifier: BSD-3-Clause
#include "substepping.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "mechanics/simulation/solve_ending.h"

namespace soft_robot_lab {
namespace {

constexpr int kRelaxationSteps = 600;  // time steps in which it must come to rest
constexpr int kPatience = 100;         // of which it takes this many before it doubles its substeps, four times at most
constexpr int kPullSteps = 30;         // over which it moves the actuators then

// The residual is that of a body at rest or of the last substep.
NewtonReport measure(SimulationParts& parts, const XpbdTask& task, const XpbdReport& done, bool at_rest) {
  NewtonTask residual;
  residual.max_iterations = 0;
  residual.tolerance = parts.options.tolerance;
  residual.predicted_m = &done.predicted_m;
  residual.inertia_per_s2 = at_rest ? 0.0 : std::pow(done.substeps / task.time_step_s, 2);
  NewtonState measured = parts.unknowns();
  NewtonReport found = parts.solver.solve(residual, measured);
  if (at_rest) return found;
  found.converged = done.stable;
  found.reason = done.stable ? "" : "the step created energy with " + std::to_string(done.substeps) + " substeps too";
  return found;
}

// One time step of xpbd; kept only where it is finite.
XpbdReport advance_in_substeps(SimulationParts& parts, const XpbdTask& task, bool at_rest, SolveReport& report) {
  const SimulationState before = parts.state;
  XpbdState moving{parts.unknowns(), parts.state.velocities_m_s, parts.state.element_forces_n};
  const XpbdReport done = parts.xpbd->advance_stably(task, moving);
  ++report.steps;
  report.iterations += done.sweeps;
  report.rejected_steps += done.rejected_steps;
  NewtonReport found;
  if (done.finite) {
    parts.accept(std::move(moving.unknowns));
    parts.state.velocities_m_s = std::move(moving.velocities_m_s);
    parts.state.element_forces_n = std::move(moving.element_forces_n);
    found = measure(parts, task, done, at_rest);
  } else {
    parts.restore(before);
    found.residual = 1.0;
    found.reason = "the step went non-finite and was undone";
  }
  tell_end(found, parts.body, report);
  return done;
}

XpbdTask substepping(const SimulationParts& parts) {
  XpbdTask task;
  task.time_step_s = parts.options.time_step_s;
  task.substep_count = parts.options.substep_count;
  task.iteration_count = parts.options.iteration_count;
  return task;
}

}  // namespace

void step_in_substeps(SimulationParts& parts, SolveReport& report) {
  const std::vector<double> from = parts.state.actuated_commands;
  std::vector<double> to;
  parts.begin_step(parts.options.time_step_s);
  for (auto& actuator : parts.actuators) {
    actuator->advance(parts.options.time_step_s);
    to.push_back(actuator->actuated_command());
  }
  XpbdTask task = substepping(parts);
  task.before_substep =
      [&](double fraction) {  // also a command without a speed limit takes the whole time step to arrive
        for (std::size_t i = 0; i < parts.actuators.size(); ++i)
          parts.actuators[i]->place(from[i] + fraction * (to[i] - from[i]));
      };
  if (!advance_in_substeps(parts, task, false, report).finite) return;
  parts.state.time_s += task.time_step_s;
  parts.remember();
}

void settle_in_substeps(SimulationParts& parts, SolveReport& report) {
  const std::vector<double> from = parts.state.actuated_commands;
  XpbdTask task = substepping(parts);
  double last_kinetic_energy = 0.0;
  for (int step = 1; step <= kRelaxationSteps; ++step) {
    parts.move_actuators(from, std::min(1.0, static_cast<double>(step) / kPullSteps));
    const XpbdReport done = advance_in_substeps(parts, task, true, report);
    if (!done.finite) break;
    if (done.kinetic_energy_j < last_kinetic_energy) parts.state.velocities_m_s.setZero();
    last_kinetic_energy = done.kinetic_energy_j;
    if (report.converged && step >= kPullSteps) break;
    if (step % kPatience == 0 && step <= 4 * kPatience) task.substep_count *= 2;
  }
  parts.state.velocities_m_s.setZero();
  if (!report.converged)
    report.message = "not at rest after " + std::to_string(report.steps) + " time steps: " + report.message;
}

}  // namespace soft_robot_lab
