// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace soft_robot_lab {

// Weights z >= 0, most of them zero, with |A z - sum of A's columns| <= tolerance: non-negative least squares (Lawson &
// Hanson 1974, ch. 23), stopped there or where no further column helps.
Eigen::VectorXd sparse_weights(const Eigen::MatrixXd& contributions, double tolerance);

}  // namespace soft_robot_lab
