// SPDX-License-Identifier: BSD-3-Clause
#include "reduced_sensitivities.h"

#include <Eigen/LU>

#include "mechanics/complementarity/multiplier_problem.h"
#include "reduced_newton.h"

namespace soft_robot_lab {
namespace {

// Row and column of a contact's slip, as NewtonSolver::respond has them; `turn`: how less its ratio's logarithm gets
// by each multiplier.
void add_friction(const ReducedConstraints::Values& constraints, const Eigen::VectorXd& y,
                  const Eigen::RowVectorXd& turn, std::size_t contact, Eigen::MatrixXd& matrix) {
  const auto& [first, second, ratio] = constraints.friction_contacts[contact];
  const Eigen::Index row = y.size() + static_cast<Eigen::Index>(contact);
  const bool held_first = !active(constraints.laws[static_cast<std::size_t>(first)], y[first]);
  const bool held_second = !active(constraints.laws[static_cast<std::size_t>(second)], y[second]);
  if (!held_first) matrix(first, row) = 1.0;
  if (!held_second) matrix(second, row) = -1.0;
  const int slip = slipping(constraints.friction_contacts[contact], y);
  if (slip == 0 || (held_first && held_second)) {
    matrix(row, row) = 1.0;
    return;
  }
  matrix.row(row).head(y.size()) = ratio * y[slip > 0 ? second : first] * turn;
  matrix(row, first) += slip > 0 ? 1.0 : -ratio;
  matrix(row, second) += slip > 0 ? -ratio : 1.0;
}

}  // namespace

ReducedSensitivities reduced_sensitivities(const ReducedModel& model, const ReducedState& state) {
  ReducedSensitivities result;
  ReducedNewton newton(model);
  if (!newton.stable(state.drives, state.at)) return result;
  const ReducedConstraints::Values constraints = newton.constraints_at(state.at, state.drives);
  const Eigen::VectorXd multipliers = all_multipliers(state.at, constraints);
  const Eigen::Index n = state.at.q.size(), r = state.at.pressures.size(), own = state.at.multipliers.size(),
                     count = multipliers.size();
  Eigen::MatrixXd sides = Eigen::MatrixXd::Zero(n + r, count);
  sides.topRows(n) = constraints.gradients;
  Eigen::MatrixXd inner = reduced_matrix(model, state.at, constraints, 0.0);
  if (!constraints.touches.empty()) inner.topLeftCorner(n, n) += model.skin.hessian(constraints.touches);
  const Eigen::MatrixXd solved = inner.partialPivLu().solve(sides).topRows(n);
  const Eigen::Index rubbing = model.constraints.friction_contact_count();
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(count + rubbing, count + rubbing);
  matrix.topLeftCorner(count, count) = constraints.gradients.transpose() * solved;
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(count + rubbing, static_cast<Eigen::Index>(state.drives.size()));
  for (Eigen::Index i = 0; i < count; ++i) {
    const ConstraintLaw& law = constraints.laws[static_cast<std::size_t>(i)];
    const bool acts = active(law, multipliers[i]);
    if (acts) {
      matrix(i, i) += law.compliance;
    } else {  // known, zero for a slack cable
      matrix.row(i).setZero();
      matrix(i, i) = 1.0;
    }
    if (i >= own) continue;  // skin follows no command
    const auto actuator = static_cast<Eigen::Index>(model.constraints.actuator_of(static_cast<std::size_t>(i)));
    if (acts) right(i, actuator) = law.offset_per_command;
    if (!acts && law.prescribed()) right(i, actuator) = law.multiplier_per_command;
  }
  if (rubbing > 0) {
    const Eigen::MatrixXd turns = model.constraints.log_ratio_gradients(state.at.q).transpose() * solved;
    for (Eigen::Index j = 0; j < rubbing; ++j)
      add_friction(constraints, multipliers, turns.row(j), static_cast<std::size_t>(j), matrix);
  }
  const Eigen::MatrixXd changes = matrix.fullPivLu().solve(right).topRows(count);
  result.stable = true;
  result.multipliers = changes.topRows(own);
  result.q = -solved * changes;
  return result;
}

}  // namespace soft_robot_lab
