// SPDX-License-Identifier: BSD-3-Clause
#include "block_matrix.h"

#include <algorithm>
#include <stdexcept>

#include "elimination_order.h"

namespace soft_robot_lab {
namespace {

Neighbours with_cliques(Neighbours neighbours, const std::vector<std::vector<int>>& cliques) {
  for (const auto& clique : cliques)
    for (int a : clique) neighbours[a].insert(neighbours[a].end(), clique.begin(), clique.end());
  for (int a = 0; a < static_cast<int>(neighbours.size()); ++a) {
    auto& list = neighbours[a];
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    list.erase(std::remove(list.begin(), list.end(), a), list.end());
  }
  return neighbours;
}

Neighbours neighbours_of(const BlockPattern& pattern) {
  Neighbours neighbours(pattern.node_count());
  for (int column = 0; column < pattern.node_count(); ++column) {
    const int b = pattern.node(column);
    for (int s = pattern.column_start()[column]; s < pattern.column_start()[column + 1]; ++s) {
      const int a = pattern.node(pattern.rows()[s]);
      neighbours[a].push_back(b);
      neighbours[b].push_back(a);
    }
  }
  return neighbours;
}

}  // namespace

BlockPattern::BlockPattern(int node_count, const std::vector<std::vector<int>>& cliques) {
  const Neighbours neighbours = with_cliques(Neighbours(node_count), cliques);
  set(elimination_order(neighbours), neighbours);
}

BlockPattern::BlockPattern(const BlockPattern& of, const std::vector<std::vector<int>>& more, Order order) {
  const Neighbours neighbours = with_cliques(neighbours_of(of), more);
  set(order == Order::kept ? of.node_ : elimination_order(neighbours), neighbours);
}

void BlockPattern::set(const std::vector<int>& order, const Neighbours& neighbours) {
  const auto node_count = static_cast<int>(neighbours.size());
  node_ = postorder(order, neighbours);
  position_.resize(node_count);
  for (int i = 0; i < node_count; ++i) position_[node_[i]] = i;
  column_start_.push_back(0);
  for (int i = 0; i < node_count; ++i) {
    const auto first = static_cast<std::ptrdiff_t>(rows_.size());
    rows_.push_back(i);
    for (int neighbour : neighbours[node_[i]])
      if (position_[neighbour] > i) rows_.push_back(position_[neighbour]);
    std::sort(rows_.begin() + first, rows_.end());
    column_start_.push_back(static_cast<int>(rows_.size()));
  }
}

int BlockPattern::slot(int row_position, int column_position) const {
  const auto begin = rows_.begin() + column_start_[column_position],
             end = rows_.begin() + column_start_[column_position + 1];
  const auto found = std::lower_bound(begin, end, row_position);
  if (found == end || *found != row_position) throw std::logic_error("block outside the matrix's pattern");
  return static_cast<int>(found - rows_.begin());
}

void BlockMatrix::add_to_diagonal(int node, double value) {
  double* diagonal = block(column_start()[position(node)]);
  diagonal[0] += value;
  diagonal[4] += value;
  diagonal[8] += value;
}

void BlockMatrix::hold(const Eigen::Matrix<bool, 3, Eigen::Dynamic>& fixed) {
  const auto is_held = [&](int axis, int node) { return node < fixed.cols() && fixed(axis, node); };
  const auto any_held = [&](int node) { return node < fixed.cols() && fixed.col(node).any(); };
  const std::vector<int>& start = column_start();
  const std::vector<int>& row = rows();
  for (int column = 0; column < node_count(); ++column) {
    const bool column_held = any_held(node(column));
    for (int s = start[column]; s < start[column + 1]; ++s) {
      if (!column_held && !any_held(node(row[s]))) continue;
      double* values = block(s);
      for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) {
          if (!is_held(i, node(row[s])) && !is_held(j, node(column))) continue;
          values[3 * j + i] = row[s] == column && i == j ? 1.0 : 0.0;
        }
      }
    }
  }
}

Eigen::Matrix3Xd BlockMatrix::multiply(const Eigen::Matrix3Xd& x) const {
  Eigen::Matrix3Xd y = Eigen::Matrix3Xd::Zero(3, node_count());
  const std::vector<int>& start = column_start();
  const std::vector<int>& row = rows();
  for (int column = 0; column < node_count(); ++column) {
    const int b = node(column);
    for (int s = start[column]; s < start[column + 1]; ++s) {
      const int a = node(row[s]);
      const Eigen::Map<const Eigen::Matrix3d> values(block(s));
      y.col(a) += values * x.col(b);
      if (a != b) y.col(b) += values.transpose() * x.col(a);
    }
  }
  return y;
}

}  // namespace soft_robot_lab
