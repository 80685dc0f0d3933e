// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/robot/scene/run_scene.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "mechanics/simulation/modal.h"

namespace soft_robot_lab {
namespace {

void add(const SolveReport& part, SolveReport& total) {
  total.converged = total.converged && part.converged;
  total.iterations += part.iterations;
  total.steps += part.steps;
  total.rejected_steps += part.rejected_steps;
  total.residual = std::max(total.residual, part.residual);
  total.wall_s += part.wall_s;
  total.inverted_elements = part.inverted_elements;
  for (const SolvePathStage& stage : part.path) enter(stage.stage, stage.count, total.path);
  for (const SolveWarning& warning : part.warnings) add_warning(warning, total.warnings);
  if (!part.message.empty()) total.message = part.message;
}

void command(Simulation& simulation, const TimedCommands& timed) {
  for (const auto& [actuator, value] : timed.commands) simulation.set_command(actuator, value);
}

SolveReport solve_in_order(Simulation& simulation, const std::vector<TimedCommands>& commands) {
  SolveReport total;
  total.converged = true;
  if (commands.empty()) add(simulation.solve_equilibrium(), total);
  for (size_t i = 0; i < commands.size() && total.converged; ++i) {
    command(simulation, commands[i]);
    add(simulation.solve_equilibrium(), total);
    if (!total.converged) total.message = "run.commands[" + std::to_string(i) + "]: " + total.message;
  }
  return total;
}

// The drive takes its time; a run may end before.
void warn_of_unfinished_commands(const Simulation& simulation, SolveReport& total) {
  for (std::size_t i = 0; i < simulation.actuators().size(); ++i) {
    const auto& actuator = simulation.actuators()[i];
    const DriveState& drive = simulation.state().drives[i];
    const double missing = drive.actuated_command - drive.command;
    if (missing == 0.0) continue;
    SolveWarning warning;
    warning.kind = "command_not_reached";
    warning.actuator = actuator->name();
    warning.size = missing;
    warning.unit = actuator->limits().unit;
    warning.commanded = drive.command;
    warning.reached = drive.actuated_command;
    std::ostringstream text;
    text << "actuator " << actuator->name() << ": commanded to " << drive.command << ", but its drive is at "
         << drive.actuated_command << " when the run ends";
    warning.text = text.str();
    add_warning(warning, total.warnings);
  }
}

void record(const Simulation& simulation, Trajectory& trajectory) {
  const int count = static_cast<int>(simulation.markers().size());
  Eigen::Matrix3Xd markers_m(3, count);
  for (int i = 0; i < count; ++i) markers_m.col(i) = simulation.marker_position(i);
  trajectory.time_s.push_back(simulation.state().time_s);
  trajectory.markers_m.push_back(std::move(markers_m));
}

SolveReport solve_in_time(Simulation& simulation, const RunSettings& run, Trajectory& trajectory) {
  SolveReport total;
  total.converged = true;
  const double step_s = simulation.options().time_step_s;
  const double close_s = 1.0e-6 * step_s;  // sums of steps miss round times by rounding
  const auto step_count = static_cast<long>(std::ceil((run.duration_s - close_s) / step_s));
  const double record_every_s = std::max(run.record_every_s, step_s);
  auto next = run.commands.begin();
  long recorded = 0;
  if (simulation.options().method == SolverOptions::Method::newton) simulation.keep_energy_ledger();
  record(simulation, trajectory);
  for (long i = 0; i < step_count; ++i) {
    const double now_s = static_cast<double>(i) * step_s;
    for (; next != run.commands.end() && next->time_s <= now_s + close_s; ++next) command(simulation, *next);
    const SolveReport step = simulation.step();
    const bool first_failure = total.converged && !step.converged;
    add(step, total);
    if (first_failure) {
      std::ostringstream text;
      text << "step " << i + 1 << " of " << step_count << ", at " << now_s << " s: " << step.message;
      total.message = text.str();
    }
    if (now_s + step_s < static_cast<double>(recorded + 1) * record_every_s - close_s) continue;
    record(simulation, trajectory);
    recorded = static_cast<long>((now_s + step_s + close_s) / record_every_s);
  }
  warn_of_unfinished_commands(simulation, total);
  return total;
}

void find_modes(const Simulation& simulation, int modes, RunReport& report) {
  const ModalResult found = modal_analysis(simulation.body(), modes);
  report.solve.converged = found.converged;
  report.solve.iterations = found.iterations;
  report.solve.residual = found.change;
  report.solve.wall_s = found.wall_s;
  if (!found.converged) report.solve.message = "the frequencies still change by more than asked for";
  report.frequencies_hz = found.frequencies_hz;
}

// A saddle point solves the equations too, but is no rest state, and has no derivative worth reporting.
void add_sensitivity(Simulation& simulation, RunReport& report) {
  try {
    report.sensitivity = simulation.marker_sensitivities();
  } catch (const std::runtime_error& error) {
    report.solve.converged = false;
    report.solve.message = error.what();
  }
}

// A body with elements turned inside out solves its equations too; no robot has that shape.
void refuse_inverted(SolveReport& solve) {
  if (solve.inverted_elements == 0 || !solve.converged) return;
  solve.converged = false;
  solve.message = std::to_string(solve.inverted_elements) +
                  " elements are inverted at the end: too soft for its loads, or meshed too coarsely";
}

}  // namespace

RunReport run_scene(Scene& scene) {
  RunReport report;
  Simulation& simulation = *scene.simulation;
  if (scene.run.mode == RunMode::dynamic) {
    report.solve = solve_in_time(simulation, scene.run, report.trajectory);
    refuse_inverted(report.solve);
    return report;
  }
  if (scene.run.mode == RunMode::modal) {
    find_modes(simulation, scene.run.modes, report);
    return report;
  }
  report.solve = solve_in_order(simulation, scene.run.commands);
  refuse_inverted(report.solve);
  if (scene.run.sensitivity && report.solve.converged) add_sensitivity(simulation, report);
  return report;
}

}  // namespace soft_robot_lab
