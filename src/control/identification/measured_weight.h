// SPDX-License-Identifier: BSD-3-Clause
// What a measured marker has to be, and what its coordinates are divided by, so that what is left has unit deviation.
#pragma once

#include <stdexcept>

#include <Eigen/Cholesky>

#include "soft_robot_lab/control/identification/fit_model.h"

namespace soft_robot_lab {

// Throws std::invalid_argument.
inline void require_finite(const MeasuredMarker& marker) {
  if (!marker.position_m.allFinite() || !marker.covariance_m2.allFinite())
    throw std::invalid_argument("marker '" + marker.name + "': position or covariance is not finite");
}

// Throws std::invalid_argument where covariance and model error together are not positive.
inline Eigen::Matrix3d measured_weight(const MeasuredMarker& measured, double model_error_m) {
  const Eigen::Matrix3d variance = measured.covariance_m2 + model_error_m * model_error_m * Eigen::Matrix3d::Identity();
  const Eigen::LLT<Eigen::Matrix3d> root(variance);
  if (root.info() != Eigen::Success || !(variance.trace() > 0.0))
    throw std::invalid_argument("marker '" + measured.name +
                                "': its covariance is not positive; give model_error_m > 0");
  return root.matrixL().solve(Eigen::Matrix3d::Identity());
}

}  // namespace soft_robot_lab
