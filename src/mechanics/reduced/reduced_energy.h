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

// The saddle function of a body without cables and chambers, least in q and greatest in r:
//   sum w mu/2 (|F|^2 - 3) - c_K + sum z w R(F) + r'c - r'B r / 2 - f'q,   B = P' V / lambda P of the pressures P
// All is an exact polynomial (VolumePolynomials; c_K is the last of them, sum w mu (J - 1)) but the third term, the
// rest of the law (PointSums), a sum over few points of weights z w (cubature).
class ReducedEnergy {
 public:
  // With every quadrature point, z = 1.
  ReducedEnergy(const Body& body, const ReducedBasis& basis);

  // Keeps only the points of positive weight; `factors`: z of each point, in their order; `body`: the same.
  void hyper_reduce(const Eigen::VectorXd& factors, const Body& body);

  struct Sums {
    double value;              // [J]
    Eigen::VectorXd force;     // d/dq
    Eigen::VectorXd mismatch;  // d/dr = c - B r
  };
  Sums sums(const Eigen::VectorXd& q, const Eigen::VectorXd& r) const;
  Eigen::MatrixXd hessian(const Eigen::VectorXd& q, const Eigen::VectorXd& r) const;  // d2/dq2
  Eigen::MatrixXd volume_gradients(const Eigen::VectorXd& q) const;                   // d2/dq dr, N x nr

  // Per point, N x points: its part of the third term's force.
  Eigen::MatrixXd point_forces(const Eigen::VectorXd& q) const { return point_sums_.forces(q); }

  const std::vector<RestPoint>& points() const { return points_; }
  const Eigen::MatrixXd& bulk_compliance() const { return bulk_compliance_; }  // B [1/Pa]
  Eigen::Index modes() const { return linear_.size(); }
  Eigen::Index pressures() const { return volumes_.count() - 1; }

 private:
  Eigen::VectorXd scales(const Eigen::VectorXd& r) const;  // of the polynomials: r and -1

  std::vector<RestPoint> points_;  // weights z w
  PointSums point_sums_;           // the same
  VolumePolynomials volumes_;
  Eigen::MatrixXd bulk_compliance_;
  Eigen::MatrixXd stretch_;  // sum w mu D'D
  Eigen::VectorXd linear_;   // sum w mu tr A_i
  Eigen::VectorXd loads_;
};

}  // namespace soft_robot_lab
