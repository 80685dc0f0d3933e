// SPDX-License-Identifier: BSD-3-Clause
#include "reduced_sensitivities.h"

#include <Eigen/LU>

#include "mechanics/complementarity/multiplier_problem.h"
#include "reduced_newton.h"

namespace soft_robot_lab {

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
  Eigen::MatrixXd matrix = constraints.gradients.transpose() * solved;
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(count, static_cast<Eigen::Index>(state.drives.size()));
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
  const Eigen::MatrixXd changes = matrix.partialPivLu().solve(right);
  result.stable = true;
  result.multipliers = changes.topRows(own);
  result.q = -solved * changes;
  return result;
}

}  // namespace soft_robot_lab
