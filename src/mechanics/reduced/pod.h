// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace soft_robot_lab {

// Proper orthogonal decomposition by the method of snapshots (Sirovich 1987): the `count` directions, or as many as the
// snapshots (columns) span, that hold most of them in the norm sum w_i u_i^2. Columns P with P' diag(w) P = 1.
Eigen::MatrixXd pod(const Eigen::MatrixXd& snapshots, const Eigen::VectorXd& weights, int count);

}  // namespace soft_robot_lab
