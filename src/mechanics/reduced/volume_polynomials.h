// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

#include "rest_points.h"

namespace soft_robot_lab {

// c_k(q) = sum over points of w psi_k (det F - 1), in m^3 times the unit of psi_k, and at last the same with psi = 1.
// As F is linear in q, each is a cubic polynomial, kept by its coefficients, exact to rounding:
//   det F - 1 = tr A + (tr^2 A - tr A^2) / 2 + det A,   A = F - 1 = sum q_i A_i
class VolumePolynomials {
 public:
  // `shares`: elements x k, the psi of each element.
  VolumePolynomials(const std::vector<RestPoint>& points, const Eigen::MatrixXd& shares);

  struct Values {
    Eigen::VectorXd values;     // of each polynomial
    Eigen::MatrixXd gradients;  // modes x polynomials
  };
  Values at(const Eigen::VectorXd& q) const;

  // sum_k scales_k d2 c_k/dq2, modes x modes.
  Eigen::MatrixXd hessian(const Eigen::VectorXd& q, const Eigen::VectorXd& scales) const;

  Eigen::Index count() const { return linear_.cols(); }

 private:
  void add_element(const std::vector<RestPoint>& points, std::size_t first, const Eigen::RowVectorXd& shares);

  Eigen::Index modes_;
  Eigen::MatrixXd linear_;                  // modes x polynomials
  std::vector<Eigen::MatrixXd> quadratic_;  // per polynomial, symmetric
  // (modes x polynomials) rows, a column for each pair i <= j: coefficients of q_i q_j in the gradient.
  Eigen::MatrixXd cubic_;
};

}  // namespace soft_robot_lab
