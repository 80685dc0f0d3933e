#include "time_stepping.h"

#include <algorithm>

#include "backward_difference.h"

namespace soft_robot_lab {
namespace {

constexpr int kDeepestHalving = 6;  // a time step is cut into at most 2^6 parts

NewtonTask task_of(const SolverOptions& options, bool last_resort) {
  NewtonTask task;
  task.tolerance = options.dynamic_tolerance;
  task.min_iterations = 1;
  task.reuse_factor = true;
  task.max_iterations = last_resort ? options.max_iterations : std::min(options.max_iterations, kStageIterations);
  return task;
}

// Makes the solution of a step of length h the state, with all that the next step knows of this one.
void accept_step(SimulationParts& parts, double h, const BackwardDifference& difference, NewtonState solved,
                 SimulationState before) {
  SimulationState& state = parts.state;
  state.velocities_m_s = (solved.positions_m - difference.positions_from_m) / difference.gamma_s;
  parts.accept(std::move(solved));
  state.time_s = before.time_s + h;
  if (parts.options.integrator == Integrator::bdf2) {
    state.previous_step_s = h;
    state.previous_positions_m = std::move(before.positions_m);
    state.previous_velocities_m_s = std::move(before.velocities_m_s);
  }
  parts.remember();
}

bool try_step(SimulationParts& parts, double h, bool last_resort, SolveReport& report) {
  SimulationState before = parts.state;
  parts.begin_step(h);
  for (auto& actuator : parts.actuators) actuator->advance(h);
  const BackwardDifference difference(before, h);
  const Eigen::Matrix3Xd predicted = difference.positions_from_m + difference.gamma_s * difference.velocities_from_m_s;
  NewtonTask task = task_of(parts.options, last_resort);
  task.inertia_per_s2 = 1.0 / (difference.gamma_s * difference.gamma_s);
  task.predicted_m = &predicted;
  NewtonState unknown = parts.unknowns();
  unknown.positions_m = before.positions_m + h * before.velocities_m_s;
  if (!parts.solve(task, unknown, report).converged && !last_resort) {
    parts.restore(before);
    return false;
  }
  accept_step(parts, h, difference, std::move(unknown), std::move(before));
  return true;
}

// What bdf2 knows of the step before lets halves differ in length; where they grow too fast, as they may afterwards,
// one step is implicit Euler's.
void advance(SimulationParts& parts, double h, int depth, SolveReport& report) {
  if (try_step(parts, h, depth == kDeepestHalving, report)) return;
  advance(parts, 0.5 * h, depth + 1, report);
  const bool first = report.converged;
  advance(parts, 0.5 * h, depth + 1, report);
  report.converged = report.converged && first;
}

}  // namespace

void step_in_time(SimulationParts& parts, double h, SolveReport& report) { advance(parts, h, 0, report); }

}  // namespace soft_robot_lab
