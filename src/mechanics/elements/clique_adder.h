// SPDX-License-Identifier: BSD-3-Clause
// Adds one constraint's second derivatives to a BlockMatrix without searching for their places each time.
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "mechanics/linear_algebra/block_matrix.h"
#include "soft_robot_lab/mechanics/constraint.h"

namespace soft_robot_lab {

class CliqueAdder : public CliqueSink {
 public:
  // Cliques of the matrix's nodes.
  CliqueAdder(BlockMatrix& matrix, const std::vector<std::vector<int>>& cliques) : matrix_(matrix) {
    for (const auto& nodes : cliques) {
      Places clique;
      clique.order.resize(nodes.size());
      std::iota(clique.order.begin(), clique.order.end(), 0);
      const auto position = [&](int i) { return matrix.position(nodes[i]); };
      std::sort(clique.order.begin(), clique.order.end(), [&](int a, int b) { return position(a) < position(b); });
      for (std::size_t a = 0; a < nodes.size(); ++a)
        for (std::size_t b = 0; b <= a; ++b)
          clique.slots.push_back(matrix.slot(position(clique.order[a]), position(clique.order[b])));
      cliques_.push_back(std::move(clique));
    }
  }

  void add_outer(int index, const std::vector<double>& coefficients, const Eigen::Matrix3d& block) override {
    each_pair(index, [&](int a, int b) -> Eigen::Matrix3d { return coefficients[a] * coefficients[b] * block; });
  }

  void add_dense(int index, const Eigen::MatrixXd& matrix) override {
    each_pair(index, [&](int a, int b) -> Eigen::Matrix3d { return matrix.block<3, 3>(3 * a, 3 * b); });
  }

 private:
  struct Places {
    std::vector<int> order;  // places in the clique, sorted by elimination
    std::vector<int> slots;  // per pair a >= b in that order
  };

  template <class Block>
  void each_pair(int index, Block block) {
    const Places& clique = cliques_[index];
    std::size_t pair = 0;
    for (std::size_t a = 0; a < clique.order.size(); ++a)
      for (std::size_t b = 0; b <= a; ++b, ++pair)
        Eigen::Map<Eigen::Matrix3d>(matrix_.block(clique.slots[pair])) += block(clique.order[a], clique.order[b]);
  }

  BlockMatrix& matrix_;
  std::vector<Places> cliques_;
};

}  // namespace soft_robot_lab
