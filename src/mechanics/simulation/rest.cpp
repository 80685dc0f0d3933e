// SPDX-License-Identifier: BSD-3-Clause
#include "rest.h"
#include "mechanics/body/gap.h"
#include "mechanics/state/free_stepping.h"
#include "mechanics/solver_constants.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>

namespace soft_robot_lab {
namespace {

bool commands_reached(const SimulationParts& parts) {
  return std::all_of(parts.state.drives.begin(), parts.state.drives.end(),
                     [](const DriveState& drive) { return drive.actuated_command == drive.command; });
}

bool needs_new_factor(const SimulationParts& parts, const SolveReport& report) {
  const auto& made = parts.workspace.newton.system().linearisation();
  if (!made || report.residual < constants::kMuchLeft * parts.options.dynamic_tolerance) return false;
  const Eigen::Matrix3Xd& here = parts.state.positions_m;
  return (made->at->positions_m - here).colwise().norm().maxCoeff() > constants::kFar * parts.body.size_m();
}

// Points at the limit of friction stick and slip by turns within a time step's tolerance. A rest state so near that
// nothing is seen to move ends that.
bool settle_by_friction(SimulationParts& parts, NewtonState& still) {
  if (still.contact.anchors_m.cols() == 0 || still.contact.pressures_pa.isZero(0.0)) return false;
  NewtonTask task;
  task.tolerance = 0.1 * parts.options.tolerance;
  task.max_iterations = constants::kSettling;
  NewtonState settled = still;
  if (!parts.workspace.newton.solve(task, settled).converged) return false;
  const double moved_m = (settled.positions_m - still.positions_m).colwise().norm().maxCoeff();
  if (moved_m > constants::kStill * parts.body.size_m()) return false;
  still = settled;
  parts.accept(std::move(settled));
  return true;
}

}  // namespace

double residual_at_rest(const SimulationParts& parts) {
  return parts.workspace.newton.rest_residual(parts.unknowns_at_step(parts.options.time_step_s));
}

void require_rest(const SimulationParts& parts) {
  const double residual = parts.workspace.newton.rest_residual(parts.unknowns_at_step());
  const double most = std::max(constants::kStillAtRest, parts.options.tolerance);
  if (residual <= most) return;
  std::ostringstream text;
  text << "no sensitivity: the present state is no equilibrium: its residual " << residual << " is out of range [0, "
       << most << "]; solve for the equilibrium first";
  throw std::runtime_error(text.str());
}

bool sleep_on(SimulationParts& parts, double h, SolveReport& report) {
  SimulationState& state = parts.state;
  if (!state.rest_residual) return false;
  bool still = commands_reached(parts) &&
               !parts.body.holds_move_between(state.contact.time_s, state.contact.time_s + h) &&
               !any_moves_between(parts.body.obstacles(), state.contact.time_s, state.contact.time_s + h);
  if (still) {
    still = parts.workspace.newton.worst_violation(parts.unknowns_at_step(h)) <= parts.options.tolerance;
  }
  if (!still) {
    state.rest_residual.reset();
    return false;
  }
  state.time_s += h;
  state.contact.time_s += h;
  ++report.steps;
  report.converged = true;
  report.residual = *state.rest_residual;
  return true;
}

void fall_asleep_where_still(SimulationParts& parts, double h, const SolveReport& report) {
  SimulationState& state = parts.state;
  const double speed_m_s = std::max(state.velocities_m_s.colwise().norm().maxCoeff(),
                                    free_speed_m_s(parts.workspace.newton.contact().free(), state.free_velocities));
  if (!report.converged || report.inverted_elements > 0 ||
      h * speed_m_s > constants::kNearlyStill * parts.body.size_m())
    return;
  if (!commands_reached(parts)) return;
  if (speed_m_s > constants::kSleepingSpeed_per_s * parts.body.size_m()) {
    if (!needs_new_factor(parts, report)) return;
    parts.workspace.newton.system().restore(nullptr);
    return;
  }
  NewtonState still = parts.unknowns_at_step(parts.options.time_step_s);
  double residual = parts.workspace.newton.rest_residual(still);
  if (residual > parts.options.tolerance && settle_by_friction(parts, still))
    residual = parts.workspace.newton.rest_residual(parts.unknowns_at_step(parts.options.time_step_s));
  const double left_m = parts.workspace.newton.creep_left_m(still, state.velocities_m_s);
  if (!(left_m <= constants::kAtRest * parts.body.size_m())) return;
  if (residual > parts.options.tolerance || !parts.workspace.newton.stable_at_rest(still)) return;
  state.rest_residual = residual;
  state.velocities_m_s.setZero();
  state.free_velocities.linear_m_s.setZero();
  state.free_velocities.angular_rad_s.setZero();
  state.hold_inertia_n.resize(3, 0);
  parts.forget_previous_step();
}

}  // namespace soft_robot_lab
