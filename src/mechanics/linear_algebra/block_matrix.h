// SPDX-License-Identifier: BSD-3-Clause
// A symmetric sparse matrix of 3x3 blocks over the nodes, lower triangle by columns, in an order that keeps its factor
// small.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include <Eigen/Core>

namespace soft_robot_lab {

// Which blocks there are, and in which order nodes are eliminated. Matrices share it.
class BlockPattern {
 public:
  // `cliques`: sets of nodes that are all coupled with one another. Orders the nodes so that a factor is cheap.
  BlockPattern(int node_count, const std::vector<std::vector<int>>& cliques);

  // Another with more cliques, in its order as far as that may be, or in a new one.
  enum class Order { kept, anew };
  BlockPattern(const BlockPattern& of, const std::vector<std::vector<int>>& more, Order order);

  int node_count() const { return static_cast<int>(position_.size()); }
  int position(int node) const { return position_[node]; }  // place of a node in the elimination order
  int node(int position) const { return node_[position]; }
  const std::vector<int>& column_start() const { return column_start_; }  // in positions
  const std::vector<int>& rows() const { return rows_; }                  // sorted, the diagonal first

  // The slot of a block with row_position >= column_position.
  int slot(int row_position, int column_position) const;

 private:
  void set(const std::vector<int>& order, const std::vector<std::vector<int>>& neighbours);

  std::vector<int> position_, node_, column_start_, rows_;
};

class BlockMatrix {
 public:
  explicit BlockMatrix(std::shared_ptr<const BlockPattern> pattern)
      : pattern_(std::move(pattern)), values_(9 * pattern_->rows().size(), 0.0) {}
  BlockMatrix(int node_count, const std::vector<std::vector<int>>& cliques)
      : BlockMatrix(std::make_shared<const BlockPattern>(node_count, cliques)) {}

  // Becomes one of another pattern, in the same memory; its values are any.
  void follow(std::shared_ptr<const BlockPattern> pattern) {
    pattern_ = std::move(pattern);
    values_.resize(9 * pattern_->rows().size());
  }

  const BlockPattern& pattern() const { return *pattern_; }
  int node_count() const { return pattern_->node_count(); }
  int position(int node) const { return pattern_->position(node); }
  int node(int position) const { return pattern_->node(position); }
  const std::vector<int>& column_start() const { return pattern_->column_start(); }
  const std::vector<int>& rows() const { return pattern_->rows(); }
  int slot(int row_position, int column_position) const { return pattern_->slot(row_position, column_position); }
  const double* block(int slot) const { return values_.data() + 9 * slot; }  // column-major
  double* block(int slot) { return values_.data() + 9 * slot; }

  void set_zero() { std::fill(values_.begin(), values_.end(), 0.0); }

  void add_to_diagonal(int node, double value);

  // Replaces rows and columns of held degrees of freedom by those of the identity. Nodes beyond the columns of `fixed`
  // are free.
  void hold(const Eigen::Matrix<bool, 3, Eigen::Dynamic>& fixed);

  Eigen::Matrix3Xd multiply(const Eigen::Matrix3Xd& x) const;

 private:
  std::shared_ptr<const BlockPattern> pattern_;
  std::vector<double> values_;
};

}  // namespace soft_robot_lab
