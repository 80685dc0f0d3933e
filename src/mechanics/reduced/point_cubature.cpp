// SPDX-License-Identifier: BSD-3-Clause
#include "point_cubature.h"

#include <algorithm>
#include <vector>

#include <Eigen/Cholesky>

namespace soft_robot_lab {
namespace {

// Least squares over the chosen columns; all free of sign.
Eigen::VectorXd least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, const std::vector<Eigen::Index>& of) {
  Eigen::MatrixXd chosen(a.rows(), static_cast<Eigen::Index>(of.size()));
  for (std::size_t i = 0; i < of.size(); ++i) chosen.col(static_cast<Eigen::Index>(i)) = a.col(of[i]);
  return (chosen.transpose() * chosen).ldlt().solve(chosen.transpose() * b);
}

// The share of the way from z to the wanted weights that leaves all non-negative; drops the columns that become zero.
void go_towards(const Eigen::VectorXd& wanted, std::vector<Eigen::Index>& chosen, Eigen::VectorXd& z) {
  double share = 1.0;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const double to = wanted[static_cast<Eigen::Index>(i)], from = z[chosen[i]];
    if (to <= 0.0) share = std::min(share, from / std::max(from - to, 1e-300));
  }
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const double to = wanted[static_cast<Eigen::Index>(i)];
    double& weight = z[chosen[i]];
    weight += share * (to - weight);
    if (to <= 0.0 && weight <= 1e-12) weight = 0.0;
  }
  chosen.erase(std::remove_if(chosen.begin(), chosen.end(), [&](Eigen::Index i) { return z[i] == 0.0; }), chosen.end());
}

}  // namespace

Eigen::VectorXd sparse_weights(const Eigen::MatrixXd& contributions, double tolerance) {
  const Eigen::VectorXd target = contributions.rowwise().sum();
  Eigen::VectorXd z = Eigen::VectorXd::Zero(contributions.cols()), rest = target;
  std::vector<Eigen::Index> chosen;
  while (rest.norm() > tolerance && static_cast<Eigen::Index>(chosen.size()) < contributions.cols()) {
    Eigen::VectorXd slopes = contributions.transpose() * rest;
    for (const Eigen::Index i : chosen) slopes[i] = 0.0;
    Eigen::Index best = 0;
    if (slopes.maxCoeff(&best) <= 0.0) break;
    chosen.push_back(best);
    z[best] = 1e-9;
    for (Eigen::VectorXd wanted; !chosen.empty();) {
      wanted = least_squares(contributions, target, chosen);
      const bool inside = wanted.minCoeff() > 0.0;
      go_towards(wanted, chosen, z);
      if (inside) break;
    }
    const Eigen::VectorXd now = target - contributions * z;
    if (now.norm() >= rest.norm()) break;
    rest = now;
  }
  return z;
}

}  // namespace soft_robot_lab
