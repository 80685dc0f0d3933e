// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "rest_points.h"

namespace soft_robot_lab {

// weight det(at_rest + A), A = sum q_i A_i: `gradient` holds A as PointGradient does.
struct DeterminantTerm {
  double weight;
  Eigen::Matrix3d at_rest;
  PointGradient gradient;
};
using DeterminantSum = std::vector<DeterminantTerm>;

// c_k(q) = sum over points of w psi_k (det F - 1), in m^3 times the unit of psi_k.
// As F is linear in q, each is a cubic polynomial, kept by its coefficients, exact to rounding (tensor_cross):
//   det(M + A) - det M = (M x M) : A / 2 + M : (A x A) / 2 + det A,   A = F - 1 = sum q_i A_i,   here M = 1
// Monomials in their order: q_i; pairs q_i q_j, i <= j, the row of i after that of i - 1; triples q_i q_j q_l,
// i <= j <= l. So the triples of i are q_i times the last pairs, from q_i q_i on.
class VolumePolynomials {
 public:
  // `shares`: elements x k, the psi of each element.
  VolumePolynomials(const std::vector<RestPoint>& points, const Eigen::MatrixXd& shares);

  // One for each sum, less its value at q = 0; none of them is empty.
  explicit VolumePolynomials(const std::vector<DeterminantSum>& sums);

  struct Values {
    Eigen::VectorXd values;    // of each polynomial
    Eigen::VectorXd gradient;  // sum_k scales_k dc_k/dq
  };
  Values at(const Eigen::VectorXd& q, const Eigen::VectorXd& scales) const;

  // dc_k/dq, modes x polynomials.
  Eigen::MatrixXd gradients(const Eigen::VectorXd& q) const;

  // sum_k scales_k d2 c_k/dq2, modes x modes.
  Eigen::MatrixXd hessian(const Eigen::VectorXd& q, const Eigen::VectorXd& scales) const;

  Eigen::Index count() const { return count_; }

 private:
  struct Coefficients;
  Eigen::Index modes_, count_;
  std::shared_ptr<const Coefficients> coefficients_;
};

}  // namespace soft_robot_lab
