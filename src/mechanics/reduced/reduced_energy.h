// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "point_sums.h"
#include "rest_points.h"
#include "soft_robot_lab/mechanics/body.h"
#include "volume_polynomials.h"

namespace soft_robot_lab {

// Displacements u = modes q with modes' M modes = 1, element multipliers p = pressures r with pressures' V pressures
// = 1.
struct ReducedBasis {
  Eigen::MatrixXd modes;      // 3*node + axis x N, zero where held [1/sqrt(kg)]
  Eigen::MatrixXd pressures;  // elements x nr [1/sqrt(m^3)]
};

// The saddle function of a neo-Hookean body without cables and chambers, least in q and greatest in r:
//   mu/2 sum w |F|^2 - mu c_K + mu/2 sum z w (det F - 1)^2 + r'c - r'r / (2 lambda) - f'q
// All is an exact polynomial (VolumePolynomials; c_K is the last of them) but the third term, a sum over few points of
// weights z w (cubature).
class ReducedEnergy {
 public:
  // With every quadrature point, z = 1.
  ReducedEnergy(const Body& body, const ReducedBasis& basis);

  // Keeps only the points of positive weight; `factors`: z of each point, in their order.
  void keep_points(const Eigen::VectorXd& factors);

  struct Sums {
    double value;              // [J]
    Eigen::VectorXd force;     // d/dq
    Eigen::VectorXd mismatch;  // d/dr = c - r / lambda
  };
  Sums sums(const Eigen::VectorXd& q, const Eigen::VectorXd& r) const;
  Eigen::MatrixXd hessian(const Eigen::VectorXd& q, const Eigen::VectorXd& r) const;  // d2/dq2
  Eigen::MatrixXd volume_gradients(const Eigen::VectorXd& q) const;                   // d2/dq dr, N x nr

  // Per point, N x points: its part in the force, at z = 1.
  Eigen::MatrixXd point_forces(const Eigen::VectorXd& q) const;

  const std::vector<RestPoint>& points() const { return points_; }
  double lambda_pa() const { return lambda_; }
  Eigen::Index modes() const { return linear_.size(); }
  Eigen::Index pressures() const { return volumes_.count() - 1; }

 private:
  Eigen::VectorXd scales(const Eigen::VectorXd& r) const;  // of the polynomials: r and -mu

  double mu_, lambda_, rest_volume_m3_ = 0.0;
  std::vector<RestPoint> points_;  // weights z w
  PointSums point_sums_;           // the same
  VolumePolynomials volumes_;
  Eigen::MatrixXd stretch_;  // sum w D'D
  Eigen::VectorXd linear_;   // sum w tr A_i
  Eigen::VectorXd loads_;
};

}  // namespace soft_robot_lab
