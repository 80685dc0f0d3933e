// SPDX-License-Identifier: BSD-3-Clause
#include "simulation_parts.h"

#include <stdexcept>

#include "solve_ending.h"

namespace soft_robot_lab {
namespace {

constexpr int kThreads = 2;  // of xpbd, on meshes large enough to be worth it

std::vector<const Constraint*> constraints_of(const std::vector<std::unique_ptr<Actuator>>& actuators) {
  std::vector<const Constraint*> all;
  for (const auto& actuator : actuators)
    for (const Constraint* constraint : actuator->constraints()) all.push_back(constraint);
  return all;
}

std::vector<SharedLength> shared_lengths_of(const std::vector<std::unique_ptr<Actuator>>& actuators,
                                            SolverOptions::Method method) {
  std::vector<SharedLength> all;
  int offset = 0;
  for (const auto& actuator : actuators) {
    for (const FrictionContact* contact : actuator->friction_contacts())
      all.push_back({contact, offset + contact->first, offset + contact->second});
    if (!all.empty() && method == SolverOptions::Method::xpbd)
      throw std::invalid_argument("actuator '" + actuator->name() +
                                  "' has friction, which solver.method xpbd does not know; must be newton");
    offset += static_cast<int>(actuator->constraints().size());
  }
  return all;
}

}  // namespace

SimulationParts::SimulationParts(Body body_in, std::vector<std::unique_ptr<Actuator>> actuators_in,
                                 std::vector<Marker> markers_in, const SolverOptions& options_in)
    : body(std::move(body_in)),
      actuators(std::move(actuators_in)),
      markers(std::move(markers_in)),
      options(options_in),
      solver(body, constraints_of(actuators), shared_lengths_of(actuators, options.method)) {
  if (options.method == SolverOptions::Method::xpbd)
    xpbd = std::make_unique<XpbdSolver>(body, constraints_of(actuators), kThreads);
}

void SimulationParts::reset() {
  state.time_s = 0.0;
  state.positions_m = body.mesh().nodes_m;
  forget_motion();
  state.element_multipliers_pa = Eigen::VectorXd::Zero(solver.element_multiplier_count());
  state.constraint_multipliers = Eigen::VectorXd::Zero(solver.constraint_count());
  state.element_forces_n = Eigen::VectorXd::Zero(xpbd ? xpbd->force_count() : 0);
  for (auto& actuator : actuators) actuator->reset();
  state.commands.resize(actuators.size());
  state.actuated_commands.resize(actuators.size());
  state.actuator_memories.resize(actuators.size());
  solver.restore(nullptr);
  remember();
}

NewtonState SimulationParts::unknowns() const {
  return {state.positions_m, state.element_multipliers_pa, state.constraint_multipliers,
          Eigen::VectorXd::Zero(solver.friction_contact_count())};
}

void SimulationParts::accept(NewtonState solved) {
  state.positions_m = std::move(solved.positions_m);
  state.element_multipliers_pa = std::move(solved.element_multipliers_pa);
  state.constraint_multipliers = std::move(solved.constraint_multipliers);
  const double* flow = solved.slips_m.data();
  for (auto& actuator : actuators) {
    const std::size_t count = actuator->friction_contacts().size();
    actuator->end_step({flow, flow + count});
    flow += count;
  }
}

void SimulationParts::remember() {
  state.linearisation = solver.linearisation();
  for (std::size_t i = 0; i < actuators.size(); ++i) {
    state.commands[i] = actuators[i]->command();
    state.actuated_commands[i] = actuators[i]->actuated_command();
    state.actuator_memories[i] = actuators[i]->memory();
  }
}

void SimulationParts::restore(const SimulationState& saved) {
  state = saved;
  if (xpbd && saved.element_forces_n.size() == 0) state.element_forces_n = xpbd->forces_of(unknowns());
  for (std::size_t i = 0; i < actuators.size(); ++i)
    actuators[i]->restore(saved.commands[i], saved.actuated_commands[i], saved.actuator_memories[i]);
}

void SimulationParts::forget_previous_step() {
  state.previous_step_s = 0.0;
  state.previous_positions_m.resize(3, 0);
  state.previous_velocities_m_s.resize(3, 0);
  state.previous_element_multipliers_pa.resize(0);
  state.previous_constraint_multipliers.resize(0);
}

void SimulationParts::forget_motion() {
  state.rest_residual.reset();
  state.inverted_steps = 0;
  forget_previous_step();
  state.velocities_m_s = Eigen::Matrix3Xd::Zero(3, body.mesh().node_count());
  state.branch_stress_pa = Eigen::VectorXd::Zero(body.viscosity().hysteresis_ratio > 0.0 ? solver.strain_count() : 0);
}

std::vector<double> SimulationParts::multipliers_of(std::size_t actuator) const {
  std::size_t first = 0;
  for (std::size_t i = 0; i < actuator; ++i) first += actuators[i]->constraints().size();
  const double* begin = state.constraint_multipliers.data() + first;
  return {begin, begin + actuators[actuator]->constraints().size()};
}

void SimulationParts::begin_step(double time_step_s) {
  for (std::size_t i = 0; i < actuators.size(); ++i)
    actuators[i]->begin_step({time_step_s, state.positions_m, state.velocities_m_s, multipliers_of(i)});
}

void SimulationParts::move_actuators(const std::vector<double>& from, double fraction) {
  for (std::size_t i = 0; i < actuators.size(); ++i) {
    const double target = actuators[i]->command();
    actuators[i]->place(from[i] + fraction * (target - from[i]));
  }
}

NewtonReport SimulationParts::solve(const NewtonTask& task, NewtonState& unknown, SolveReport& report) {
  const NewtonReport newton = solver.solve(task, unknown);
  ++report.steps;
  report.iterations += newton.iterations;
  report.factorisations += newton.factorisations;
  report.rejected_steps += newton.shortened + newton.convexified + (newton.converged ? 0 : 1);
  tell_end(newton, body, report);
  return newton;
}

NewtonReport SimulationParts::solve_from_below(const NewtonTask& task, NewtonState& unknown, SolveReport& report) {
  if (solver.friction_contact_count() > 0) return {};
  unknown = unknowns();
  const NewtonReport descent = solver.descend(task, unknown);
  report.iterations += descent.iterations;
  report.factorisations += descent.factorisations;
  report.rejected_steps += descent.shortened + descent.convexified;
  NewtonState bottom = unknown;
  const NewtonReport newton = solve(task, unknown, report);
  if (!newton.converged) unknown = std::move(bottom);
  return newton;
}

}  // namespace soft_robot_lab
