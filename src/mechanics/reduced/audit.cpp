// SPDX-License-Identifier: BSD-3-Clause
#include "audit.h"

#include <cmath>

#include "mechanics/newton/newton_solver.h"
#include "mechanics/simulation/workspace.h"
#include "mechanics/solver_constants.h"

namespace soft_robot_lab {
namespace {

// Small beside the square of any frequency of a robot [1/s^2]: it brings the inertia of the state into the residual,
// and hardly any into the matrix.
constexpr double kInertia_per_s2 = 1.0;
// Relative to the largest force: with more left the last step may be half of the way only.
constexpr double kResidual = 1e-4;
constexpr int kIterations = 6, kIterationsOfSkin = 15;  // where skin may touch, which is found by iterating

Eigen::Matrix3Xd as_columns(const Eigen::VectorXd& vector) {
  return Eigen::Map<const Eigen::Matrix3Xd>(vector.data(), 3, vector.size() / 3);
}

}  // namespace

Audit::Audit(const ReducedModel& reduced, std::shared_ptr<const Model> full)
    : reduced_(reduced), full_(std::move(full)), newton_(std::make_unique<NewtonSolver>(full_->tables().newton)) {}

Audit::~Audit() = default;

AuditResult Audit::at_rest(const ReducedState& state) { return iterate(state, nullptr); }

AuditResult Audit::in_motion(const ReducedState& state) {
  const double h = state.previous_step_s;
  if (h == 0.0) return iterate(state, nullptr);
  const double drag_per_s = full_->body().viscosity().rayleigh_mass_per_s;
  const Eigen::VectorXd acceleration = (state.velocity - state.previous_velocity) / h + drag_per_s * state.velocity;
  return iterate(state, &acceleration);
}

ContactState Audit::contact_at(const Eigen::Matrix3Xd& positions_m, const ReducedState& state) const {
  ContactState contact = newton_->contact().untouched(positions_m, state.time_s);
  if (reduced_.skin.places() > 0) reduced_.skin.add_pressures(state.at.pushes_n, contact.pressures_pa);
  return contact;
}

AuditResult Audit::iterate(const ReducedState& state, const Eigen::VectorXd* acceleration) {
  const Eigen::Matrix3Xd start_m = reduced_.positions_m(state.at.q);
  NewtonState at{start_m,
                 reduced_.basis.pressures * state.at.pressures,
                 state.at.multipliers,
                 Eigen::VectorXd::Zero(newton_->tables().friction_contact_count()),
                 std::make_shared<const DriveStates>(state.drives),
                 contact_at(start_m, state)};
  Eigen::Matrix3Xd predicted_m;
  NewtonTask task;
  task.tolerance = kResidual;
  task.min_iterations = 1;
  task.max_iterations = reduced_.skin.places() > 0 ? kIterationsOfSkin : kIterations;
  task.reuse_below = constants::kNearRest;
  if (acceleration) {
    predicted_m = start_m - as_columns(reduced_.basis.modes * *acceleration) / kInertia_per_s2;
    task.inertia_per_s2 = kInertia_per_s2;
    task.predicted_m = &predicted_m;
  }
  const NewtonReport report = newton_->solve(task, at);
  AuditResult result;
  result.found = report.converged && report.convexified == 0;
  result.iterations = report.iterations;
  const auto& markers = full_->markers();
  result.markers_m.resize(3, static_cast<Eigen::Index>(markers.size()));
  for (std::size_t m = 0; m < markers.size(); ++m) {
    const Eigen::Vector3d there_m = markers[m].position(at.positions_m);
    result.markers_m.col(static_cast<Eigen::Index>(m)) = there_m;
    result.estimate_m += (there_m - markers[m].position(start_m)).squaredNorm() / static_cast<double>(markers.size());
  }
  result.estimate_m = std::sqrt(result.estimate_m);
  result.positions_m = std::move(at.positions_m);
  result.element_multipliers_pa = std::move(at.element_multipliers_pa);
  result.constraint_multipliers = std::move(at.constraint_multipliers);
  return result;
}

}  // namespace soft_robot_lab
