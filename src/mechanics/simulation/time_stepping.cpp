// SPDX-License-Identifier: BSD-3-Clause
#include "time_stepping.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "mechanics/state/backward_difference.h"
#include "mechanics/state/free_stepping.h"
#include "prediction.h"
#include "rest.h"
#include "solve_ending.h"
#include "mechanics/contact/fast_obstacles.h"
#include "mechanics/newton/untangle.h"
#include "viscous_step.h"
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
  int depth = 0;  // of halving since a first try; below 0: too long for one

  double fraction() const { return to - from; }
  Part first_half() const { return {from, 0.5 * (from + to), depth + 1}; }
  Part second_half() const { return {0.5 * (from + to), to, depth + 1}; }
};

// Where a step ends; asked for only where a ledger is kept or a hold moves.
StepEnd end_of_step(SimulationParts& parts, const SimulationState& before, const BackwardDifference& difference,
                    const ViscousStep& viscous, const FreeStep& free, const NewtonState& solved) {
  const auto masses = parts.body.node_masses_kg().asDiagonal();
  const Eigen::Matrix3Xd& velocities_m_s = parts.state.velocities_m_s;
  const Eigen::Matrix3Xd way_m = solved.positions_m - before.positions_m;
  const FreeColumns free_way = soft_robot_lab::free_way(before.contact.free, solved.contact.free);
  Eigen::Matrix3Xd inertia_n = (velocities_m_s - difference.velocities_from_m_s) / difference.gamma_s * masses;
  StepEnd end;
  end.trapezoidal = difference.trapezoidal;
  end.inertia_j =
      inertia_n.cwiseProduct(way_m).sum() + free.inertia_n(solved.contact.free).cwiseProduct(free_way).sum();
  const double drag_per_s = parts.body.viscosity().rayleigh_mass_per_s;
  Eigen::Matrix3Xd drag_n;
  if (drag_per_s > 0.0) {
    drag_n = drag_per_s * velocities_m_s * masses;
    end.drag_j = drag_n.cwiseProduct(way_m).sum();
    inertia_n += drag_n;
  }
  const bool moves = parts.body.holds_move();
  end.work = parts.workspace.newton.work(solved, viscous.strain_target(), inertia_n, way_m, free_way, moves);
  end.damping_n = end.work.viscous_n;
  if (drag_n.cols() > 0) end.damping_n = end.damping_n.cols() > 0 ? end.damping_n + drag_n : drag_n;
  if (!moves) return end;
  parts.state.hold_inertia_n = parts.body.fixed().select(inertia_n, 0.0);
  if (end.work.viscous_n.cols() > 0)
    parts.state.hold_inertia_n += parts.body.fixed().select(end.work.viscous_n, 0.0).matrix();
  return end;
}

// Makes the end of a step of length h the state, with all that the next step knows of this one. `solved`: its forces
// balance.
void accept_step(SimulationParts& parts, double h, const BackwardDifference& difference, const ViscousStep& viscous,
                 const FreeStep& free, NewtonState found, SimulationState before, bool solved) {
  SimulationState& state = parts.state;
  state.branch_stress_pa = viscous.branch_stress_pa(parts.workspace.newton.energies(), found.positions_m);
  state.velocities_m_s = (found.positions_m - difference.positions_from_m) / difference.gamma_s;
  state.free_velocities = free.velocities(found.contact.free);
  if (parts.options.integrator == Integrator::tr_bdf2) {
    state.accelerations_m_s2 = (state.velocities_m_s - difference.velocities_from_m_s) / difference.gamma_s;
    state.free_forces_n = free.inertia_n(found.contact.free);
  }
  if (parts.energy || parts.body.holds_move()) {
    StepEnd end = end_of_step(parts, before, difference, viscous, free, found);
    if (parts.energy && solved) parts.energy->add_step(parts, before, std::move(end), found, state);
  }
  parts.accept(std::move(found));
  state.time_s = before.time_s + h;
  state.previous_step_s = h;
  state.previous_positions_m = std::move(before.positions_m);
  state.previous_velocities_m_s = std::move(before.velocities_m_s);
  state.previous_element_multipliers_pa = std::move(before.element_multipliers_pa);
  state.previous_constraint_multipliers = std::move(before.constraint_multipliers);
  state.previous_pressures_pa = std::move(before.contact.pressures_pa);
  state.previous_free = std::move(before.contact.free);
  state.previous_free_velocities = std::move(before.free_velocities);
}

bool opened_or_closed(const ContactState& before, const ContactState& after) {
  return ((before.pressures_pa.array() > 0.0) != (after.pressures_pa.array() > 0.0)).any() ||
         ((before.rigid_forces_n.array() > 0.0) != (after.rigid_forces_n.array() > 0.0)).any();
}

double kinetic_j(const SimulationParts& parts, const Eigen::Matrix3Xd& velocities_m_s) {
  return 0.5 * parts.body.node_masses_kg().dot(velocities_m_s.colwise().squaredNorm().transpose());
}

void come_to_rest(SimulationParts& parts) {
  parts.state.velocities_m_s.setZero();
  parts.state.free_velocities.linear_m_s.setZero();
  parts.state.free_velocities.angular_rad_s.setZero();
  parts.forget_previous_step();
}

// The last resort of a step of implicit Euler, which found no solution, must not add energy: it comes to rest where it
// would, or stays where it was where even the shape that was found has too much. `task`: without inertia. Whether the
// velocity is to be kept.
bool without_more_energy(SimulationParts& parts, const NewtonTask& task, const FreeStep& free, double h,
                         NewtonState& found, SolveReport& report) {
  NewtonState start = parts.unknowns();
  if (found.slips_m.size() == 0) found.slips_m = start.slips_m;
  const FreeObstacles& obstacles = parts.workspace.newton.contact().free();
  const double rise_j = parts.workspace.newton.potential_rise_j(task, start, found);
  const double before_j = kinetic_j(parts, parts.state.velocities_m_s) +
                          free_kinetic_j(obstacles, start.contact.free, parts.state.free_velocities);
  const double after_j = kinetic_j(parts, (found.positions_m - start.positions_m) / h) +
                         free_kinetic_j(obstacles, found.contact.free, free.velocities(found.contact.free));
  if (rise_j + after_j <= before_j) return true;
  if (!(rise_j <= before_j)) found = std::move(start);
  report.message += rise_j <= before_j ? "; it would move with more energy than it had: it rests where it is"
                                       : "; its shape would have more energy: the one before stays, at rest";
  return false;
}

enum class Outcome { taken, impact, failed };

// One solve. Over an impact a rule of second order would go on as before it, and may gain energy: the state stays.
Outcome try_rule(SimulationParts& parts, double h, StepRule rule, bool last_resort, SolveReport& report) {
  SimulationState before = parts.state;
  const BackwardDifference difference(before, h, rule);
  const ViscousStep viscous(parts.body, parts.workspace.newton.energies(), before, difference, h);
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
  NewtonState unknown = predict(before, h, rule);
  parts.body.place_held_nodes(before.contact.time_s, unknown.positions_m);
  unknown.slips_m = Eigen::VectorXd::Zero(parts.workspace.newton.tables().friction_contact_count());
  unknown.drives = std::make_shared<const DriveStates>(parts.state.drives);
  const FreeStep free(parts.workspace.newton.contact().free(), before, difference);
  unknown.contact.free = free.predicted();
  unknown.free_inertia = free.inertia();
  // Halves of a step in which skin meets skin are found at once; the way down the energy takes seconds there.
  const bool descends = last_resort || !parts.body.touches_itself();
  const bool solved = parts.solve(task, unknown, report).converged ||
                      (descends && parts.solve_from_below(task, unknown, report).converged);
  if (!solved && !last_resort) return Outcome::failed;
  bool moves_on = true;
  if (!solved) {
    enter(SolveStage::last_resort, 1, report.path);
    task.inertia_per_s2 = 0.0;
    moves_on = without_more_energy(parts, task, free, h, unknown, report);
  }
  const bool second_order = difference.weight_before > 0.0 || difference.trapezoidal;
  if (second_order && opened_or_closed(before.contact, unknown.contact)) return Outcome::impact;
  const RigidOverlap overlap = overlap_on_way(parts.body, parts.workspace.newton.contact(), unknown.contact);
  if (overlap.found() && !last_resort) return Outcome::failed;
  accept_step(parts, h, difference, viscous, free, std::move(unknown), std::move(before), solved);
  if (!moves_on) come_to_rest(parts);
  if (parts.energy && !solved) parts.energy->notice_rescue(parts, parts.state);
  if (overlap.found()) report_overlap(overlap, parts.body, "", report);
  return Outcome::taken;
}

bool try_step(SimulationParts& parts, double h, StepRule rule, bool last_resort, SolveReport& report) {
  const Outcome outcome = try_rule(parts, h, rule, last_resort, report);
  if (outcome != Outcome::impact) return outcome == Outcome::taken;
  return try_rule(parts, h, StepRule::implicit_euler, last_resort, report) == Outcome::taken;
}

// Places what moves by itself where a part of the step ends. The obstacles' time is ahead of the body's where an
// equilibrium was found at the end of their motion.
void move_to_end(SimulationParts& parts, double h, const CommandPath& path, const Part& part) {
  path.move(parts, part.to);
  parts.state.contact.time_s += part.fraction() * h;
}

// Both stages of TR-BDF2, or none.
Outcome try_both_stages(SimulationParts& parts, double h, const CommandPath& path, const Part& part,
                        SolveReport& report) {
  const SimulationState before = parts.state;
  const std::optional<EnergyKeeper> energy_before = parts.energy;
  const double middle = part.from + kTrapezoidalShare * part.fraction();
  const Part first{part.from, middle, part.depth}, second{middle, part.to, part.depth};
  Outcome outcome = Outcome::failed;
  const auto try_stage = [&](const Part& stage, StepRule rule) {
    parts.begin_step(stage.fraction() * h);
    move_to_end(parts, h, path, stage);
    outcome = try_rule(parts, stage.fraction() * h, rule, false, report);
    return outcome == Outcome::taken;
  };
  if (!try_stage(first, StepRule::trapezoidal) || !try_stage(second, StepRule::bdf2_after_trapezoidal)) {
    parts.state = before;
    parts.energy = energy_before;
  }
  return outcome;
}

// What the forces say where a motion starts. Those of a tangle say nothing of use.
bool knows_accelerations(SimulationParts& parts) {
  SimulationState& state = parts.state;
  if (state.accelerations_m_s2.cols() > 0) return true;
  const NewtonSolver& newton = parts.workspace.newton;
  if (state.previous_step_s > 0.0 || newton.energies().sums_at(state.positions_m).inverted > 0) return false;
  const NewtonForces forces = newton.forces(parts.unknowns(), viscosity_now(parts.body, newton.energies(), state));
  Eigen::Matrix3Xd net_n =
      newton.energies().loads.all_n() - forces.elastic_n - forces.viscous_n - forces.contact_n - forces.driven_n;
  for (const Eigen::Matrix3Xd& pull_n : forces.pulls_n) net_n -= pull_n;
  state.accelerations_m_s2 = net_n * parts.body.node_masses_kg().cwiseInverse().asDiagonal() -
                             parts.body.viscosity().rayleigh_mass_per_s * state.velocities_m_s;
  state.accelerations_m_s2 = parts.body.fixed().select(0.0, state.accelerations_m_s2);
  FreeColumns free_n = forces.free_n;
  add_free_gradient(newton.contact().free(), state.contact.free, nullptr, free_n);
  state.free_forces_n = -free_n;
  return true;
}

bool try_part(SimulationParts& parts, double h, const CommandPath& path, const Part& part, bool last_resort,
              SolveReport& report) {
  const bool bdf2 = parts.options.integrator == Integrator::bdf2 && !last_resort;
  if (parts.options.integrator == Integrator::tr_bdf2 && !last_resort && knows_accelerations(parts)) {
    const Outcome outcome = try_both_stages(parts, h, path, part, report);
    if (outcome != Outcome::impact) return outcome == Outcome::taken;
  }
  if (part.fraction() < 1.0 || parts.options.integrator == Integrator::tr_bdf2) parts.begin_step(part.fraction() * h);
  move_to_end(parts, h, path, part);
  return try_step(parts, part.fraction() * h, bdf2 ? StepRule::bdf2 : StepRule::implicit_euler, last_resort, report);
}

// What bdf2 knows of the step before lets halves differ in length; where they grow too fast, as they may afterwards,
// one step is implicit Euler's. A part that finds no solution at last falls down its energy, which never adds any.
void advance(SimulationParts& parts, double h, const CommandPath& path, const Part& part, SolveReport& report) {
  const double obstacles_s = parts.state.contact.time_s;
  const bool last_resort = part.depth >= constants::kDeepestHalving ||
                           report.iterations > constants::kStepBudget * parts.options.max_iterations;
  if (part.depth >= 0) {
    if (try_part(parts, h, path, part, last_resort, report)) return;
    enter(SolveStage::halving, 1, report.path);
  }
  parts.state.contact.time_s = obstacles_s;
  advance(parts, h, path, part.first_half(), report);
  const bool first = report.converged;
  const std::string why = report.message;
  advance(parts, h, path, part.second_half(), report);
  if (report.converged && !first) report.message = why;
  report.converged = report.converged && first;
}

// All of a step; it begins in parts where an obstacle is so fast that it might pass through skin.
Part whole_step(const ObstacleCuts& cuts) {
  const double count = std::min(cuts.parts, constants::kMostParts);
  return {0.0, 1.0, -static_cast<int>(std::ceil(std::log2(count)))};
}

bool is_power_of_two(int number) { return number > 0 && (number & (number - 1)) == 0; }

// A step from a shape whose inverted elements are laid out anew, with ever more of their surroundings the longer they
// have been so; kept only where they stay untangled.
bool advance_untangled(SimulationParts& parts, double h, const ObstacleCuts& cuts, SolveReport& report) {
  SimulationState& state = parts.state;
  const SimulationState before = state;
  const std::optional<EnergyKeeper> energy_before = parts.energy;
  const Untangled untangled = untangle(parts.body, state.inverted_steps, state.positions_m);
  if (untangled.nodes.empty()) return false;
  for (const int node : untangled.nodes) state.velocities_m_s.col(node).setZero();
  state.element_multipliers_pa.setZero();
  parts.forget_previous_step();
  enter(SolveStage::untangle, static_cast<int>(untangled.elements.size()), report.path);
  advance(parts, h, CommandPath(parts, h), whole_step(cuts), report);
  if (report.converged && report.inverted_elements == 0) {
    report_untangled(static_cast<int>(untangled.elements.size()), report);
    return true;
  }
  parts.state = before;
  parts.energy = energy_before;
  return false;
}

}  // namespace

void step_in_time(SimulationParts& parts, double h, SolveReport& report) {
  if (sleep_on(parts, h, report)) return;
  const SimulationState& state = parts.state;
  const ObstacleCuts cuts = parts_for_obstacles(parts.body, parts.workspace.newton.contact(), state.positions_m,
                                                state.velocities_m_s, state.contact, state.free_velocities, h);
  const int inverted_steps = state.inverted_steps;
  if (!is_power_of_two(inverted_steps) || !advance_untangled(parts, h, cuts, report))
    advance(parts, h, CommandPath(parts, h), whole_step(cuts), report);
  parts.state.inverted_steps = report.inverted_elements > 0 ? inverted_steps + 1 : 0;
  report_overlap(overlap_at(parts.body, parts.workspace.newton.contact(), state.contact), parts.body,
                 "; choose a shorter solver.time_step_s", report);
  report_fast_obstacle(cuts, constants::kMostParts, parts.body, h, report);
  fall_asleep_where_still(parts, h, report);
}

}  // namespace soft_robot_lab
