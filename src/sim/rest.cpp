#include "rest.h"

namespace soft_robot_lab {
namespace {

constexpr double kStill = 1e-7;  // times the body's size: the largest motion of a node in one step

bool commands_reached(const SimulationParts& parts) {
  for (std::size_t i = 0; i < parts.actuators.size(); ++i) {
    const Actuator& actuator = *parts.actuators[i];
    if (actuator.command() != actuator.actuated_command() ||
        actuator.actuated_command() != parts.state.actuated_commands[i])
      return false;
  }
  return true;
}

}  // namespace

double residual_at_rest(SimulationParts& parts) {
  parts.begin_step(parts.options.time_step_s);
  return parts.solver.rest_residual(parts.unknowns());
}

bool sleep_on(SimulationParts& parts, double h, SolveReport& report) {
  SimulationState& state = parts.state;
  if (!state.rest_residual) return false;
  bool still = commands_reached(parts);
  if (still) {
    parts.begin_step(h);
    still = parts.solver.worst_violation(parts.unknowns()) <= parts.options.tolerance;
  }
  if (!still) {
    state.rest_residual.reset();
    return false;
  }
  state.time_s += h;
  ++report.steps;
  report.converged = true;
  report.residual = *state.rest_residual;
  return true;
}

void fall_asleep_where_still(SimulationParts& parts, double h, const SolveReport& report) {
  SimulationState& state = parts.state;
  const double motion_m = h * state.velocities_m_s.colwise().norm().maxCoeff();
  if (!report.converged || report.inverted_elements > 0 || motion_m > kStill * parts.body.size_m()) return;
  if (!commands_reached(parts)) return;
  const double residual = residual_at_rest(parts);
  if (residual > parts.options.tolerance) return;
  const bool stable = parts.solver.stable_at_rest(parts.unknowns());
  parts.remember();  // the new linearisation
  if (!stable) return;
  state.rest_residual = residual;
  state.velocities_m_s.setZero();
  parts.forget_previous_step();
}

}  // namespace soft_robot_lab
