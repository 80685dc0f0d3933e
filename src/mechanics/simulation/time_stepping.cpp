// SPDX-License-Identifier: BSD-3-Clause
#include "time_stepping.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "backward_difference.h"
#include "free_stepping.h"
#include "prediction.h"
#include "rest.h"
#include "solve_ending.h"
#include "mechanics/newton/untangle.h"
#include "mechanics/elements/viscous_step.h"
#include "mechanics/solver_constants.h"

namespace soft_robot_lab {
namespace {

// What the actuators do within a time step, which begins here for them: they move evenly, also those without a speed
// limit.
struct CommandPath {
  std::vector<double> from, to;

  CommandPath(SimulationParts& parts, double h) {
    parts.begin_step(h);
    from = parts.state.actuated_commands();
    parts.advance_actuators(h);
    to = parts.state.actuated_commands();
  }
  void move(SimulationParts& parts, double fraction) const {
    parts.place_actuators(fraction == 1.0 ? to : from, to, fraction);
  }
};

// A part of a time step, from one share of it to another.
struct Part {
  double from = 0.0, to = 1.0;
  int depth = 0;

  double fraction() const { return to - from; }
  Part first_half() const { return {from, 0.5 * (from + to), depth + 1}; }
  Part second_half() const { return {0.5 * (from + to), to, depth + 1}; }
};

// Where a step ends; asked for only where a ledger is kept or a hold moves.
StepForces forces_at_end(const SimulationParts& parts, const BackwardDifference& difference, const ViscousStep& viscous,
                         const FreeStep& free, const NewtonState& solved, const Eigen::Matrix3Xd& velocities_m_s) {
  const auto masses = parts.body.node_masses_kg().asDiagonal();
  return {parts.workspace.newton.forces(solved, viscous.strain_target()),
          (velocities_m_s - difference.velocities_from_m_s) / difference.gamma_s * masses,
          parts.body.viscosity().rayleigh_mass_per_s * velocities_m_s * masses, free.inertia_n(solved.contact.free)};
}

// Makes the solution of a step of length h the state, with all that the next step knows of this one.
void accept_step(SimulationParts& parts, double h, const BackwardDifference& difference, const ViscousStep& viscous,
                 const FreeStep& free, NewtonState solved, SimulationState before) {
  SimulationState& state = parts.state;
  state.branch_stress_pa = viscous.branch_stress_pa(parts.workspace.newton, solved.positions_m);
  state.velocities_m_s = (solved.positions_m - difference.positions_from_m) / difference.gamma_s;
  state.free_velocities = free.velocities(solved.contact.free);
  if (parts.energy || parts.body.holds_move()) {
    const StepForces end = forces_at_end(parts, difference, viscous, free, solved, state.velocities_m_s);
    if (parts.energy) parts.energy->add_step(parts, before, end, solved, state);
    if (parts.body.holds_move())
      state.hold_inertia_n = parts.body.fixed().select(end.forces.viscous_n + end.inertia_n + end.drag_n, 0.0);
  }
  parts.accept(std::move(solved));
  state.time_s = before.time_s + h;
  state.previous_step_s = h;
  state.previous_positions_m = std::move(before.positions_m);
  state.previous_velocities_m_s = std::move(before.velocities_m_s);
  state.previous_element_multipliers_pa = std::move(before.element_multipliers_pa);
  state.previous_constraint_multipliers = std::move(before.constraint_multipliers);
  state.previous_free = std::move(before.contact.free);
  state.previous_free_velocities = std::move(before.free_velocities);
}

bool opened_or_closed(const ContactState& before, const ContactState& after) {
  return ((before.pressures_pa.array() > 0.0) != (after.pressures_pa.array() > 0.0)).any() ||
         ((before.rigid_forces_n.array() > 0.0) != (after.rigid_forces_n.array() > 0.0)).any();
}

bool try_step(SimulationParts& parts, double h, Integrator integrator, bool last_resort, SolveReport& report) {
  SimulationState before = parts.state;
  const BackwardDifference difference(before, h, integrator);
  const ViscousStep viscous(parts.body, parts.workspace.newton, before, difference, h);
  // M ((x - x~) / gamma^2 + a (x - x_from) / gamma) = c M (x - x_from - gamma v_from / c) / gamma^2 with c = 1 + a
  // gamma
  const double slowed = 1.0 + parts.body.viscosity().rayleigh_mass_per_s * difference.gamma_s;
  const Eigen::Matrix3Xd predicted =
      difference.positions_from_m + difference.gamma_s / slowed * difference.velocities_from_m_s;
  NewtonTask task;
  task.tolerance = parts.options.dynamic_tolerance;
  task.min_iterations = 1;
  task.max_iterations = std::min(parts.options.max_iterations, constants::kStageIterations);
  task.reuse_factor = true;
  task.inertia_per_s2 = slowed / (difference.gamma_s * difference.gamma_s);
  task.predicted_m = &predicted;
  task.strain_target = viscous.strain_target();
  NewtonState unknown = predict(before, h, integrator);
  parts.body.place_held_nodes(before.contact.time_s, unknown.positions_m);
  unknown.slips_m = Eigen::VectorXd::Zero(parts.workspace.newton.friction_contact_count());
  unknown.drives = std::make_shared<const DriveStates>(parts.state.drives);
  unknown.contact = before.contact;
  const FreeStep free(parts.workspace.newton.contact().free(), before, difference);
  unknown.contact.free = free.predicted();
  unknown.free_inertia = free.inertia();
  const bool solved =
      parts.solve(task, unknown, report).converged || parts.solve_from_below(task, unknown, report).converged;
  if (!solved && !last_resort) return false;
  if (!solved) enter(SolveStage::last_resort, 1, report.path);
  // Over an impact bdf2 would go on as before it, and may gain energy.
  if (difference.weight_before > 0.0 && opened_or_closed(before.contact, unknown.contact))
    return try_step(parts, h, Integrator::implicit_euler, last_resort, report);
  accept_step(parts, h, difference, viscous, free, std::move(unknown), std::move(before));
  return true;
}

// What bdf2 knows of the step before lets halves differ in length; where they grow too fast, as they may afterwards,
// one step is implicit Euler's. A part that finds no solution at last falls down its energy, which never adds any.
void advance(SimulationParts& parts, double h, const CommandPath& path, const Part& part, SolveReport& report) {
  if (part.depth > 0) parts.begin_step(part.fraction() * h);
  path.move(parts, part.to);
  // The obstacles' time: ahead of the body's where an equilibrium was found at the end of their motion.
  const double obstacles_s = parts.state.contact.time_s;
  parts.state.contact.time_s = obstacles_s + part.fraction() * h;
  const bool last_resort = part.depth == constants::kDeepestHalving ||
                           report.iterations > constants::kStepBudget * parts.options.max_iterations;
  if (try_step(parts, part.fraction() * h, parts.options.integrator, last_resort, report)) return;
  enter(SolveStage::halving, 1, report.path);
  parts.state.contact.time_s = obstacles_s;
  advance(parts, h, path, part.first_half(), report);
  const bool first = report.converged;
  advance(parts, h, path, part.second_half(), report);
  report.converged = report.converged && first;
}

bool is_power_of_two(int number) { return number > 0 && (number & (number - 1)) == 0; }

// A step from a shape whose inverted elements are laid out anew, with ever more of their surroundings the longer they
// have been so; kept only where they stay untangled.
bool advance_untangled(SimulationParts& parts, double h, SolveReport& report) {
  SimulationState& state = parts.state;
  const SimulationState before = state;
  const std::optional<EnergyKeeper> energy_before = parts.energy;
  const Untangled untangled = untangle(parts.body, state.inverted_steps, state.positions_m);
  if (untangled.nodes.empty()) return false;
  for (const int node : untangled.nodes) state.velocities_m_s.col(node).setZero();
  state.element_multipliers_pa.setZero();
  parts.forget_previous_step();
  enter(SolveStage::untangle, static_cast<int>(untangled.elements.size()), report.path);
  advance(parts, h, CommandPath(parts, h), Part(), report);
  if (report.converged && report.inverted_elements == 0) {
    tell_untangled(static_cast<int>(untangled.elements.size()), report);
    return true;
  }
  parts.state = before;
  parts.energy = energy_before;
  return false;
}

}  // namespace

void step_in_time(SimulationParts& parts, double h, SolveReport& report) {
  if (sleep_on(parts, h, report)) return;
  const int inverted_steps = parts.state.inverted_steps;
  if (!is_power_of_two(inverted_steps) || !advance_untangled(parts, h, report))
    advance(parts, h, CommandPath(parts, h), Part(), report);
  parts.state.inverted_steps = report.inverted_elements > 0 ? inverted_steps + 1 : 0;
  fall_asleep_where_still(parts, h, report);
}

}  // namespace soft_robot_lab
