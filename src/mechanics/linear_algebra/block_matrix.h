// SPDX-License-Identifier: BSD-3-Clause
// A symmetric sparse matrix of 3x3 blocks over the nodes, lower triangle by columns, in an order that keeps its factor
// small.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace soft_robot_lab {

class BlockMatrix {
 public:
  // `cliques`: sets of nodes that are all coupled with one another. Orders the nodes by nested dissection (METIS).
  BlockMatrix(int node_count, const std::vector<std::vector<int>>& cliques);

  int node_count() const { return static_cast<int>(position_.size()); }
  int position(int node) const { return position_[node]; }  // place of a node in the elimination order
  int node(int position) const { return node_[position]; }
  const std::vector<int>& column_start() const { return column_start_; }     // in positions
  const std::vector<int>& rows() const { return rows_; }                     // sorted, the diagonal first
  const double* block(int slot) const { return values_.data() + 9 * slot; }  // column-major
  double* block(int slot) { return values_.data() + 9 * slot; }

  // The slot of a block with row_position >= column_position.
  int slot(int row_position, int column_position) const;

  void set_zero() { std::fill(values_.begin(), values_.end(), 0.0); }

  void add_to_diagonal(int node, double value);

  // Replaces rows and columns of held degrees of freedom by those of the identity. Nodes beyond the columns of `fixed`
  // are free.
  void hold(const Eigen::Matrix<bool, 3, Eigen::Dynamic>& fixed);

  Eigen::Matrix3Xd multiply(const Eigen::Matrix3Xd& x) const;

 private:
  std::vector<int> position_, node_, column_start_, rows_;
  std::vector<double> values_;
};

}  // namespace soft_robot_lab
