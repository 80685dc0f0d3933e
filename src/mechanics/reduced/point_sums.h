// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "rest_points.h"

namespace soft_robot_lab {

// sum over points of w/2 (det F - 1)^2 with its derivatives by q, four points at a time.
class PointSums {
 public:
  explicit PointSums(const std::vector<RestPoint>& points);

  double add_force(const Eigen::VectorXd& q, double scale,
                   Eigen::VectorXd& force) const;  // returns the sum times scale
  void add_hessian(const Eigen::VectorXd& q, double scale, Eigen::MatrixXd& hessian) const;

 private:
  struct Groups;
  Eigen::Index modes_;
  std::shared_ptr<const Groups> groups_;
};

}  // namespace soft_robot_lab
