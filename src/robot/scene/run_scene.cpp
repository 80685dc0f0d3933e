// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/robot/scene/run_scene.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "mechanics/simulation/actuator_warnings.h"
#include "mechanics/simulation/modal.h"
#include "scene_motion.h"

namespace soft_robot_lab {
namespace {

void command(SceneMotion& motion, const TimedCommands& timed) {
  for (const auto& [actuator, value] : timed.commands) motion.set_command(actuator, value);
}

void report_early_end(double done, double all, const std::string& unit, SolveReport& total) {
  std::ostringstream text;
  text << "ended after " << done << " of " << all << " " << unit << ", as asked";
  total.converged = false;
  total.message = text.str();
}

// Whether the run shall end here; then `total` says so.
bool ends_early(const RunProgress& progress, double done, double all, const std::string& unit, SolveReport& total) {
  if (!progress || progress(done / all) || done >= all) return false;
  report_early_end(done, all, unit, total);
  return true;
}

SolveReport solve_in_order(SceneMotion& motion, const std::vector<TimedCommands>& commands,
                           const RunProgress& progress) {
  SolveReport total;
  total.converged = true;
  if (commands.empty()) add_report(motion.solve_equilibrium(), total);
  for (size_t i = 0; i < commands.size() && total.converged; ++i) {
    command(motion, commands[i]);
    add_report(motion.solve_equilibrium(), total);
    if (!total.converged) total.message = "run.commands[" + std::to_string(i) + "]: " + total.message;
    const auto done = static_cast<double>(i + 1), all = static_cast<double>(commands.size());
    if (total.converged && ends_early(progress, done, all, "commands", total)) break;
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

void record(SceneMotion& motion, Trajectory& trajectory) {
  trajectory.time_s.push_back(motion.time_s());
  trajectory.markers_m.push_back(motion.markers_m());
  const DriveStates& drives = motion.drives();
  Eigen::Matrix2Xd& commands = trajectory.commands.emplace_back(2, static_cast<Eigen::Index>(drives.size()));
  for (std::size_t i = 0; i < drives.size(); ++i)
    commands.col(static_cast<Eigen::Index>(i)) << drives[i].command, drives[i].actuated_command;
  trajectory.free.push_back(motion.simulation().state().contact.free);
}

SolveReport solve_in_time(SceneMotion& motion, const RunSettings& run, double step_s, const RunProgress& progress,
                          Trajectory& trajectory) {
  SolveReport total;
  total.converged = true;
  const double close_s = 1.0e-6 * step_s;  // sums of steps miss round times by rounding
  const auto step_count = static_cast<long>(std::ceil((run.duration_s - close_s) / step_s));
  const double record_every_s = std::max(run.record_every_s, step_s);
  auto next = run.commands.begin();
  long recorded = 0;
  record(motion, trajectory);
  for (long i = 0; i < step_count; ++i) {
    const double now_s = static_cast<double>(i) * step_s;
    for (; next != run.commands.end() && next->time_s <= now_s + close_s; ++next) command(motion, *next);
    const SolveReport step = motion.step();
    const bool first_failure = total.converged && !step.converged;
    add_report(step, total);
    if (first_failure) {
      std::ostringstream text;
      text << "step " << i + 1 << " of " << step_count << ", at " << now_s << " s: " << step.message;
      total.message = text.str();
    }
    const std::function<bool()>& asked = motion.simulation().interrupt();
    if (step.interrupted && asked && asked()) report_early_end(now_s, run.duration_s, "s", total);
    const bool ends = step.interrupted || ends_early(progress, now_s + step_s, run.duration_s, "s", total);
    if (!ends && now_s + step_s < static_cast<double>(recorded + 1) * record_every_s - close_s) continue;
    if (!step.interrupted || motion.time_s() > trajectory.time_s.back()) record(motion, trajectory);
    if (ends) break;
    recorded = static_cast<long>((now_s + step_s + close_s) / record_every_s);
  }
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

// The simulation keeps the last state, with what is wrong with that of a reduced model.
void end(SceneMotion& motion, RunReport& report) {
  motion.audit_end(report.solve);
  motion.show();
  report.audits = motion.audits();
  report.left_reduced = motion.left();
  for (const SolveWarning& warning : motion.simulation().unmodelled_contact())
    add_warning(warning, report.solve.warnings);
  if (!motion.reduced()) return;
  report.solve.inverted_elements = motion.inverted_elements();
  const Simulation& simulation = motion.simulation();
  for (std::size_t i = 0; i < simulation.actuators().size(); ++i)
    for (const SolveWarning& warning :
         actuator_warnings(simulation.actuator_state(static_cast<int>(i)), simulation.body()))
      add_warning(warning, report.solve.warnings);
}

}  // namespace

RunReport run_in_time(SceneMotion& motion, const RunSettings& run, const RunProgress& progress) {
  RunReport report;
  report.solve = solve_in_time(motion, run, motion.simulation().options().time_step_s, progress, report.trajectory);
  end(motion, report);
  warn_of_unfinished_commands(motion.simulation(), report.solve);
  refuse_inverted(report.solve);
  return report;
}

namespace {

RunReport run_as_asked(Scene& scene, const RunProgress& progress) {
  RunReport report;
  Simulation& simulation = *scene.simulation;
  SceneMotion motion(scene);
  if (scene.run.mode == RunMode::dynamic) {
    if (simulation.options().method == SolverOptions::Method::newton && !motion.reduced())
      simulation.keep_energy_ledger();
    return run_in_time(motion, scene.run, progress);
  }
  if (scene.run.mode == RunMode::modal) {
    find_modes(simulation, scene.run.modes, report);
    return report;
  }
  report.solve = solve_in_order(motion, scene.run.commands, progress);
  end(motion, report);
  refuse_inverted(report.solve);
  if (scene.run.sensitivity && report.solve.converged) add_sensitivity(simulation, report);
  return report;
}

}  // namespace

RunReport run_scene(Scene& scene, const RunProgress& progress) {
  RunReport report = run_as_asked(scene, progress);
  std::vector<SolveWarning> warnings;
  for (const auto& part : {scene.warnings, report.solve.warnings})
    for (const SolveWarning& warning : part) add_warning(warning, warnings);
  report.solve.warnings = std::move(warnings);
  return report;
}

}  // namespace soft_robot_lab
