// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "rest_points.h"
#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {

// What the energy of silicone (material_law.h) has at each point beyond mu/2 (|F|^2 - 3) - mu (J - 1), the polynomials
// of ReducedEnergy, times the point's weight; with its derivatives by q, four points at a time:
//   neo_hookean    mu/2 (J - 1)^2
//   mooney_rivlin  c10 (J - 1)^2 + c01 (I2 - I1 - 2 (J - 1))
//   yeoh           c1 (J - 1)^2 + c2 phi^2 + c3 phi^3
class PointSums {
 public:
  PointSums(const std::vector<RestPoint>& points, const Body& body);

  double add_force(const Eigen::VectorXd& q, Eigen::VectorXd& force) const;  // returns the energy [J]
  void add_hessian(const Eigen::VectorXd& q, Eigen::MatrixXd& hessian) const;
  Eigen::MatrixXd forces(const Eigen::VectorXd& q) const;  // of each point, modes x points

 private:
  struct Groups;
  Eigen::Index modes_;
  std::shared_ptr<const Groups> groups_;
};

}  // namespace soft_robot_lab
