// SPDX-License-Identifier: BSD-3-Clause
// Points that stand at the limit of friction: which of them slip on, and which stick, as something changes a little.
#pragma once

#include <Eigen/Core>

namespace soft_robot_lab {

// r >= 0 of the points that slip, zero of those that stick, in what each slip takes off the traction:
//   r - coupling r - beyond >= 0,   r (r - coupling r - beyond) = 0
// beyond: how far the traction of each would exceed its limit if all stuck; coupling: what slips do to one another.
Eigen::VectorXd slip_rates(const Eigen::MatrixXd& coupling, const Eigen::VectorXd& beyond);

// The same where all slip, whichever way.
Eigen::MatrixXd slips_of_all(const Eigen::MatrixXd& coupling, const Eigen::MatrixXd& beyond);

}  // namespace soft_robot_lab
