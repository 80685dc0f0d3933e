// SPDX-License-Identifier: BSD-3-Clause
#include "reduced_sensitivities.h"

#include <Eigen/LU>

#include "mechanics/newton/multiplier_problem.h"

namespace soft_robot_lab {

ReducedSensitivities reduced_sensitivities(const ReducedModel& model, const ReducedState& state) {
  ReducedSensitivities result;
  if (!stable(model, state.drives, state.at)) return result;
  const ReducedConstraints::Values constraints = model.constraints.at(state.at.q, state.at.multipliers, state.drives);
  const Eigen::Index n = state.at.q.size(), r = state.at.pressures.size(), count = state.at.multipliers.size();
  Eigen::MatrixXd sides = Eigen::MatrixXd::Zero(n + r, count);
  sides.topRows(n) = constraints.gradients;
  const Eigen::MatrixXd solved =
      reduced_matrix(model, state.at, constraints, 0.0).partialPivLu().solve(sides).topRows(n);
  Eigen::MatrixXd matrix = constraints.gradients.transpose() * solved;
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(count, static_cast<Eigen::Index>(state.drives.size()));
  for (Eigen::Index i = 0; i < count; ++i) {
    const ConstraintLaw& law = constraints.laws[static_cast<std::size_t>(i)];
    const auto actuator = static_cast<Eigen::Index>(model.constraints.actuator_of(static_cast<std::size_t>(i)));
    if (active(law, state.at.multipliers[i])) {
      matrix(i, i) += law.compliance;
      right(i, actuator) = law.offset_per_command;
    } else {  // known, zero for a slack cable
      matrix.row(i).setZero();
      matrix(i, i) = 1.0;
      if (law.prescribed()) right(i, actuator) = law.multiplier_per_command;
    }
  }
  result.stable = true;
  result.multipliers = matrix.partialPivLu().solve(right);
  result.q = -solved * result.multipliers;
  return result;
}

}  // namespace soft_robot_lab
