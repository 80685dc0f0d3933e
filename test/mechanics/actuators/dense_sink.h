// SPDX-License-Identifier: BSD-3-Clause
// Collects a constraint's Hessian for tests.
#pragma once

#include <vector>

#include "soft_robot_lab/mechanics/constraint.h"

namespace soft_robot_lab {

// A constraint's Hessian over the nodes, with carried points put back onto theirs.
class DenseSink : public CliqueSink {
 public:
  DenseSink(const Constraint& constraint, Eigen::Index nodes)
      : points_(constraint.carried_points()),
        cliques_(constraint.cliques()),
        hessian(Eigen::MatrixXd::Zero(3 * nodes, 3 * nodes)) {}

  void add_outer(int clique, const std::vector<double>& coefficients, const Eigen::Matrix3d& block) override {
    add(clique,
        [&](std::size_t i, std::size_t j) -> Eigen::Matrix3d { return coefficients[i] * coefficients[j] * block; });
  }
  void add_dense(int clique, const Eigen::MatrixXd& matrix) override {
    add(clique, [&](std::size_t i, std::size_t j) -> Eigen::Matrix3d {
      return matrix.block<3, 3>(3 * static_cast<Eigen::Index>(i), 3 * static_cast<Eigen::Index>(j));
    });
  }

 private:
  EmbeddedPoint carrier(int member) const {
    return member < 0 ? points_[static_cast<std::size_t>(~member)] : EmbeddedPoint{{member}, {1.0}};
  }
  template <class Block>
  void add(int clique, Block block) {
    const Clique& members = cliques_[static_cast<std::size_t>(clique)];
    for (std::size_t i = 0; i < members.size(); ++i) {
      for (std::size_t j = 0; j < members.size(); ++j) {
        const EmbeddedPoint a = carrier(members[i]), b = carrier(members[j]);
        for (std::size_t k = 0; k < a.nodes.size(); ++k)
          for (std::size_t l = 0; l < b.nodes.size(); ++l)
            hessian.block<3, 3>(3 * a.nodes[k], 3 * b.nodes[l]) += a.weights[k] * b.weights[l] * block(i, j);
      }
    }
  }

  std::vector<EmbeddedPoint> points_;
  std::vector<Clique> cliques_;

 public:
  Eigen::MatrixXd hessian;
};

}  // namespace soft_robot_lab
