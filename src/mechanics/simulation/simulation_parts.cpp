// SPDX-License-Identifier: BSD-3-Clause
#include "simulation_parts.h"

#include "solve_ending.h"

namespace soft_robot_lab {

SimulationParts::SimulationParts(std::shared_ptr<const Model> model_in)
    : model(std::move(model_in)),
      body(model->body()),
      actuators(model->actuators()),
      markers(model->markers()),
      options(model->options()),
      workspace(model->tables()) {}

void SimulationParts::reset() {
  state.time_s = 0.0;
  state.positions_m = body.mesh().nodes_m;
  forget_motion();
  state.element_multipliers_pa = Eigen::VectorXd::Zero(workspace.newton.tables().element_multiplier_count());
  state.constraint_multipliers = Eigen::VectorXd::Zero(workspace.newton.tables().constraint_count());
  state.contact = workspace.newton.contact().untouched(state.positions_m, 0.0);
  state.free_velocities = workspace.newton.contact().free().velocities_at_start();
  state.element_forces_n = Eigen::VectorXd::Zero(workspace.xpbd ? workspace.xpbd->force_count() : 0);
  state.drives.clear();
  for (const auto& actuator : actuators) state.drives.push_back(actuator->rest_state());
  workspace.newton.system().restore(nullptr);
  state.linearisation = nullptr;
}

NewtonState SimulationParts::unknowns() const {
  Eigen::Matrix3Xd positions_m = state.positions_m;
  body.place_held_nodes(state.contact.time_s, positions_m);
  return {std::move(positions_m),
          state.element_multipliers_pa,
          state.constraint_multipliers,
          Eigen::VectorXd::Zero(workspace.newton.tables().friction_contact_count()),
          std::make_shared<const DriveStates>(state.drives),
          state.contact};
}

void SimulationParts::accept(NewtonState solved) {
  state.positions_m = std::move(solved.positions_m);
  state.element_multipliers_pa = std::move(solved.element_multipliers_pa);
  state.constraint_multipliers = std::move(solved.constraint_multipliers);
  state.contact = std::move(solved.contact);
  workspace.newton.contact().commit(state.positions_m, state.contact);
  const double* flow = solved.slips_m.data();
  for (std::size_t i = 0; i < actuators.size(); ++i) {
    const std::size_t count = actuators[i]->friction_contacts().size();
    actuators[i]->end_step({flow, flow + count}, state.drives[i]);
    flow += count;
  }
}

void SimulationParts::set_state(const SimulationState& saved) {
  state = saved;
  for (std::size_t i = 0; i < actuators.size(); ++i)
    actuators[i]->place(saved.drives[i].actuated_command, state.drives[i]);  // within its limits
  if (workspace.xpbd && saved.element_forces_n.size() == 0)
    state.element_forces_n = workspace.xpbd->forces_of(unknowns());
}

void SimulationParts::forget_previous_step() {
  state.previous_step_s = 0.0;
  state.previous_positions_m.resize(3, 0);
  state.previous_velocities_m_s.resize(3, 0);
  state.previous_element_multipliers_pa.resize(0);
  state.previous_constraint_multipliers.resize(0);
  state.previous_pressures_pa.resize(0);
  state.previous_free = {};
  state.previous_free_velocities = {};
  state.accelerations_m_s2.resize(3, 0);
  state.free_forces_n.resize(3, 0);
}

void SimulationParts::forget_motion() {
  state.rest_residual.reset();
  state.inverted_steps = 0;
  forget_previous_step();
  state.hold_inertia_n.resize(3, 0);
  state.velocities_m_s = Eigen::Matrix3Xd::Zero(3, body.mesh().node_count());
  state.free_velocities.linear_m_s.setZero();
  state.free_velocities.angular_rad_s.setZero();
  state.branch_stress_pa = Eigen::VectorXd::Zero(
      body.viscosity().hysteresis_ratio > 0.0 ? workspace.newton.energies().springs.strain_count() : 0);
}

std::vector<double> SimulationParts::multipliers_of(std::size_t actuator) const {
  std::size_t first = 0;
  for (std::size_t i = 0; i < actuator; ++i) first += actuators[i]->constraints().size();
  const double* begin = state.constraint_multipliers.data() + first;
  return {begin, begin + actuators[actuator]->constraints().size()};
}

ActuatorReading SimulationParts::reading_of(std::size_t actuator) const {
  const Actuator& chosen = *actuators.at(actuator);
  const DriveState& drive = state.drives.at(actuator);
  ActuatorReading reading = chosen.observe(state.positions_m, multipliers_of(actuator), drive);
  reading.name = chosen.name();
  reading.command = drive.command;
  reading.actuated_command = drive.actuated_command;
  return reading;
}

void SimulationParts::begin_step(double time_step_s) {
  for (std::size_t i = 0; i < actuators.size(); ++i)
    actuators[i]->begin_step({time_step_s, state.positions_m, state.velocities_m_s, multipliers_of(i)},
                             state.drives[i]);
}

NewtonState SimulationParts::unknowns_at_step(double time_step_s) const {
  DriveStates drives = state.drives;
  for (std::size_t i = 0; i < actuators.size(); ++i)
    actuators[i]->begin_step({time_step_s, state.positions_m, state.velocities_m_s, multipliers_of(i)}, drives[i]);
  NewtonState asked = unknowns();
  asked.drives = std::make_shared<const DriveStates>(std::move(drives));
  return asked;
}

void SimulationParts::advance_actuators(double time_step_s) {
  for (std::size_t i = 0; i < actuators.size(); ++i) actuators[i]->advance(time_step_s, state.drives[i]);
}

void SimulationParts::place_actuators(const std::vector<double>& from, const std::vector<double>& to, double fraction) {
  for (std::size_t i = 0; i < actuators.size(); ++i)
    actuators[i]->place(from[i] + fraction * (to[i] - from[i]), state.drives[i]);
}

bool SimulationParts::solve_or_go_back(const std::function<void(SolveReport&)>& solve, SolveReport& report) {
  const Interrupt::Solve running(workspace.interrupt, options.time_limit_s);
  if (!workspace.interrupt.may_end()) {
    solve(report);
    return true;
  }
  const SimulationState before = state;
  const std::optional<EnergyKeeper> energy_before = energy;
  try {
    workspace.interrupt.check();
    solve(report);
    return true;
  } catch (const SolveInterrupted& interrupted) {
    state = before;
    energy = energy_before;
    workspace.newton.abandon();
    workspace.newton.system().restore(workspace.xpbd ? nullptr : before.linearisation);
    if (workspace.xpbd) workspace.xpbd->abandon();
    report.converged = false;
    report.interrupted = true;
    report.message = interrupted.why;
    report.warnings.clear();
    return false;
  }
}

NewtonReport SimulationParts::solve(const NewtonTask& task, NewtonState& unknown, SolveReport& report) {
  const NewtonReport newton = workspace.newton.solve(task, unknown);
  ++report.steps;
  report.iterations += newton.iterations;
  report.factorisations += newton.factorisations;
  report.rejected_steps += newton.shortened + newton.convexified + (newton.converged ? 0 : 1);
  enter(SolveStage::newton, newton.iterations, report.path);
  if (newton.shortened > 0) enter(SolveStage::line_search, newton.shortened, report.path);
  if (newton.convexified > 0) enter(SolveStage::convexify, newton.convexified, report.path);
  report_end(newton, body, report);
  return newton;
}

NewtonReport SimulationParts::solve_from_below(const NewtonTask& task, NewtonState& unknown, SolveReport& report) {
  if (workspace.newton.tables().friction_contact_count() > 0) return {};
  const std::shared_ptr<const FreeInertia> free_inertia = unknown.free_inertia;
  unknown = unknowns();
  unknown.free_inertia = free_inertia;
  const NewtonReport descent = workspace.newton.descend(task, unknown);
  report.iterations += descent.iterations;
  report.factorisations += descent.factorisations;
  report.rejected_steps += descent.shortened + descent.convexified;
  enter(SolveStage::energy_descent, descent.iterations, report.path);
  NewtonState bottom = unknown;
  const NewtonReport newton = solve(task, unknown, report);
  if (!newton.converged) unknown = std::move(bottom);
  return newton;
}

}  // namespace soft_robot_lab
