#include "time_stepping.h"

#include <algorithm>

#include "backward_difference.h"
#include "prediction.h"
#include "rest.h"
#include "viscous_step.h"

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
void accept_step(SimulationParts& parts, double h, const BackwardDifference& difference, const ViscousStep& viscous,
                 NewtonState solved, SimulationState before) {
  SimulationState& state = parts.state;
  state.branch_stress_pa = viscous.branch_stress_pa(parts.solver, solved.positions_m);
  state.velocities_m_s = (solved.positions_m - difference.positions_from_m) / difference.gamma_s;
  parts.accept(std::move(solved));
  state.time_s = before.time_s + h;
  state.previous_step_s = h;
  state.previous_positions_m = std::move(before.positions_m);
  state.previous_velocities_m_s = std::move(before.velocities_m_s);
  state.previous_element_multipliers_pa = std::move(before.element_multipliers_pa);
  state.previous_constraint_multipliers = std::move(before.constraint_multipliers);
  parts.remember();
}

bool try_step(SimulationParts& parts, double h, bool last_resort, SolveReport& report) {
  SimulationState before = parts.state;
  parts.begin_step(h);
  for (auto& actuator : parts.actuators) actuator->advance(h);
  const BackwardDifference difference(before, h, parts.options.integrator);
  const ViscousStep viscous(parts.body, parts.solver, before, difference, h);
  // M ((x - x~) / gamma^2 + a (x - x_from) / gamma) = c M (x - x_from - gamma v_from / c) / gamma^2 with c = 1 + a
  // gamma
  const double slowed = 1.0 + parts.body.viscosity().rayleigh_mass_per_s * difference.gamma_s;
  const Eigen::Matrix3Xd predicted =
      difference.positions_from_m + difference.gamma_s / slowed * difference.velocities_from_m_s;
  NewtonTask task = task_of(parts.options, last_resort);
  task.inertia_per_s2 = slowed / (difference.gamma_s * difference.gamma_s);
  task.predicted_m = &predicted;
  task.pull = viscous.pull();
  NewtonState unknown = predict(before, h, parts.options.integrator);
  unknown.flows_m = Eigen::VectorXd::Zero(parts.solver.junction_count());
  if (!parts.solve(task, unknown, report).converged && !last_resort) {
    parts.restore(before);
    return false;
  }
  accept_step(parts, h, difference, viscous, std::move(unknown), std::move(before));
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

void step_in_time(SimulationParts& parts, double h, SolveReport& report) {
  if (sleep_on(parts, h, report)) return;
  advance(parts, h, 0, report);
  fall_asleep_where_still(parts, h, report);
}

}  // namespace soft_robot_lab
