// SPDX-License-Identifier: BSD-3-Clause
// Adds one constraint's second derivatives to a BlockMatrix without searching for their places each time.
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "mechanics/linear_algebra/block_matrix.h"
#include "soft_robot_lab/mechanics/constraint.h"

namespace soft_robot_lab {

// Where in matrices of one pattern the blocks of cliques are.
class CliquePlaces {
 public:
  // Cliques of the matrix's nodes.
  CliquePlaces(const BlockPattern& matrix, const std::vector<std::vector<int>>& cliques) {
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

  // Calls add(slot, member a, member b) for every block of a clique.
  template <class Add>
  void each_pair(int index, Add add) const {
    const Places& clique = cliques_[static_cast<std::size_t>(index)];
    std::size_t pair = 0;
    for (std::size_t a = 0; a < clique.order.size(); ++a)
      for (std::size_t b = 0; b <= a; ++b, ++pair) add(clique.slots[pair], clique.order[a], clique.order[b]);
  }

 private:
  struct Places {
    std::vector<int> order;  // places in the clique, sorted by elimination
    std::vector<int> slots;  // per pair a >= b in that order
  };
  std::vector<Places> cliques_;
};

class CliqueAdder : public CliqueSink {
 public:
  CliqueAdder(BlockMatrix& matrix, const CliquePlaces& places) : matrix_(matrix), places_(places) {}

  void add_outer(int index, const std::vector<double>& coefficients, const Eigen::Matrix3d& block) override {
    places_.each_pair(index, [&](int slot, int a, int b) { at(slot) += coefficients[a] * coefficients[b] * block; });
  }

  void add_dense(int index, const Eigen::MatrixXd& matrix) override {
    places_.each_pair(index, [&](int slot, int a, int b) { at(slot) += matrix.block<3, 3>(3 * a, 3 * b); });
  }

 private:
  Eigen::Map<Eigen::Matrix3d> at(int slot) { return Eigen::Map<Eigen::Matrix3d>(matrix_.block(slot)); }

  BlockMatrix& matrix_;
  const CliquePlaces& places_;
};

}  // namespace soft_robot_lab
