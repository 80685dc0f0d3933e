// SPDX-License-Identifier: BSD-3-Clause
#include "block_cholesky.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "panel_kernels.h"

namespace soft_robot_lab {
namespace {

// Before it is taken.
void require_memory(std::ptrdiff_t doubles) {
  const double needed_gb = 8e-9 * static_cast<double>(doubles);
  if (needed_gb <= kMostMemory_gb) return;
  std::ostringstream text;
  text << "the mesh takes at least " << needed_gb << " GB to factorise, at most " << kMostMemory_gb
       << " are taken; choose a larger body.element_size_m, or body.element: linear";
  throw std::invalid_argument(text.str());
}

// Rows of each column of the factor below the diagonal, and each column's parent in the elimination tree.
struct ColumnStructure {
  std::vector<std::vector<int>> rows;
  std::vector<int> parent;
};

// What it holds itself is a part of what the factor will take, and refused as early.
ColumnStructure column_structure(const BlockPattern& matrix) {
  const int count = matrix.node_count();
  ColumnStructure columns{std::vector<std::vector<int>>(count), std::vector<int>(count, -1)};
  std::vector<std::vector<int>> children(count);
  std::vector<int> mark(count, -1);
  std::ptrdiff_t doubles = 0;
  for (int j = 0; j < count; ++j) {
    auto& rows = columns.rows[j];
    const auto take = [&](int row) {
      if (row <= j || mark[row] == j) return;
      mark[row] = j;
      rows.push_back(row);
    };
    for (int s = matrix.column_start()[j]; s < matrix.column_start()[j + 1]; ++s) take(matrix.rows()[s]);
    for (int child : children[j])
      for (int row : columns.rows[child]) take(row);
    doubles += 9 * (1 + static_cast<std::ptrdiff_t>(rows.size()));
    require_memory(doubles);
    std::sort(rows.begin(), rows.end());
    if (rows.empty()) continue;
    columns.parent[j] = rows.front();
    children[rows.front()].push_back(j);
  }
  return columns;
}

// Explicit zeros that may be stored for fewer, larger dense blocks.
bool worth_merging(int columns, double zeros, double entries) {
  const double fraction = zeros / entries;
  if (columns <= 4) return fraction < 0.7;
  if (columns <= 16) return fraction < 0.25;
  return fraction < 0.08;
}

}  // namespace

FactorPattern::FactorPattern(const BlockPattern& matrix) {
  order_.resize(matrix.node_count());
  for (int i = 0; i < matrix.node_count(); ++i) order_[i] = matrix.node(i);
  merge_columns(matrix);

  std::vector<int> supernode_of(matrix.node_count());
  for (std::size_t s = 0; s < nodes_.size(); ++s)
    for (int j = 0; j < nodes_[s].columns; ++j) supernode_of[nodes_[s].first + j] = static_cast<int>(s);
  std::vector<int> depth(nodes_.size(), 0);
  for (int s = static_cast<int>(nodes_.size()) - 1; s >= 0; --s) {
    Supernode& node = nodes_[s];
    if (node.rows.empty()) continue;
    const int parent = supernode_of[node.rows.front()];
    depth[s] = depth[parent] + 1;
    nodes_[parent].children.insert(nodes_[parent].children.begin(), s);
    const Supernode& above = nodes_[parent];
    for (int row : node.rows) {
      const bool pivot = row < above.first + above.columns;
      node.local_rows.push_back(
          pivot ? row - above.first
                : above.columns + static_cast<int>(std::lower_bound(above.rows.begin(), above.rows.end(), row) -
                                                   above.rows.begin()));
    }
  }

  // Updates of even and odd depths live on two stacks, so that a front never overwrites its children.
  std::ptrdiff_t top[2] = {0, 0}, highest[2] = {0, 0};
  for (std::size_t s = 0; s < nodes_.size(); ++s) {
    Supernode& node = nodes_[s];
    const std::ptrdiff_t k = 3 * node.columns, r = 3 * static_cast<std::ptrdiff_t>(node.rows.size());
    node.panel = factor_size_;
    factor_size_ += (k + r) * k;
    if (!node.children.empty()) top[(depth[s] + 1) % 2] = nodes_[node.children.front()].update;
    node.update = top[depth[s] % 2];
    top[depth[s] % 2] += r * r;
    highest[depth[s] % 2] = std::max(highest[depth[s] % 2], top[depth[s] % 2]);
    const double kd = static_cast<double>(k), rd = static_cast<double>(r);
    flops_ += kd * kd * kd / 3.0 + kd * kd * rd + kd * rd * rd;
  }
  for (std::size_t s = 0; s < nodes_.size(); ++s)
    if (depth[s] % 2 == 1) nodes_[s].update += highest[0];
  stack_size_ = highest[0] + highest[1];
  require_memory(factor_size_ + stack_size_);
}

BlockCholesky::BlockCholesky(std::shared_ptr<const FactorPattern> pattern) { follow(std::move(pattern)); }

void BlockCholesky::follow(std::shared_ptr<const FactorPattern> pattern) {
  pattern_ = std::move(pattern);
  factor_.resize(static_cast<std::size_t>(pattern_->factor_size_));
  stack_.resize(static_cast<std::size_t>(pattern_->stack_size_));
  signs_.resize(3 * pattern_->order_.size());
}

void FactorPattern::merge_columns(const BlockPattern& matrix) {
  auto columns = column_structure(matrix);
  std::vector<double> zeros;  // explicit zeros, per supernode
  for (int j = 0; j < matrix.node_count(); ++j) {
    Supernode node;
    node.first = j;
    node.columns = 1;
    node.rows = std::move(columns.rows[j]);
    double zeros_here = 0.0;
    // The supernode just before is this one's last child when its first row is this column: try to join them.
    while (!nodes_.empty() && !nodes_.back().rows.empty() && nodes_.back().rows.front() < node.first + node.columns) {
      const Supernode& child = nodes_.back();
      const double extra = child.columns * (node.columns + static_cast<double>(node.rows.size()) -
                                            static_cast<double>(child.rows.size()));
      const int joined = child.columns + node.columns;
      const double entries = joined * (joined + 1) / 2.0 + joined * static_cast<double>(node.rows.size());
      if (!worth_merging(joined, zeros.back() + zeros_here + extra, entries)) break;
      zeros_here += zeros.back() + extra;
      node.first = child.first;
      node.columns = joined;
      nodes_.pop_back();
      zeros.pop_back();
    }
    nodes_.push_back(std::move(node));
    zeros.push_back(zeros_here);
  }
}

namespace {

// Of blocks of three: nothing reads what lies above them.
void clear_lower(int rows, int columns, double* matrix) {
  for (std::ptrdiff_t j = 0; j < columns; ++j) std::fill(matrix + j * rows + j - j % 3, matrix + (j + 1) * rows, 0.0);
}

// A node's row of a vector; a call of std::copy would take longer than this.
void copy_row(const double* from, double* to) {
  to[0] = from[0];
  to[1] = from[1];
  to[2] = from[2];
}

}  // namespace

void BlockCholesky::assemble_front(const BlockMatrix& matrix, const Supernode& node, std::vector<int>& place) {
  const int pivots = node.columns, below = static_cast<int>(node.rows.size());
  const int k = 3 * pivots, r = 3 * below, m = k + r;
  double* panel = factor_.data() + node.panel;
  double* update = stack_.data() + node.update;
  clear_lower(m, k, panel);
  clear_lower(r, r, update);

  for (int j = 0; j < pivots; ++j) place[node.first + j] = j;
  for (int i = 0; i < below; ++i) place[node.rows[i]] = pivots + i;
  for (int j = 0; j < pivots; ++j) {
    const int column = node.first + j;
    for (int s = matrix.column_start()[column]; s < matrix.column_start()[column + 1]; ++s) {
      const double* block = matrix.block(s);
      double* target = panel + static_cast<std::ptrdiff_t>(3 * j) * m + 3 * place[matrix.rows()[s]];
      for (int c = 0; c < 3; ++c)
        for (int i = 0; i < 3; ++i) target[c * m + i] = block[3 * c + i];
    }
  }

  for (int child_index : node.children) {
    const Supernode& child = pattern_->nodes_[child_index];
    const int count = static_cast<int>(child.local_rows.size()), rows = 3 * count;
    const double* source = stack_.data() + child.update;
    for (int j = 0; j < count; ++j) {
      const int column = child.local_rows[j];
      const bool pivot = column < pivots;
      const std::ptrdiff_t ld = pivot ? m : r;
      double* target = pivot ? panel + 3 * column * ld : update + 3 * (column - pivots) * ld;
      const int shift = pivot ? 0 : pivots;
      for (int c = 0; c < 3; ++c) {
        const double* from = source + static_cast<std::ptrdiff_t>(3 * j + c) * rows;
        double* to = target + c * ld;
        for (int i = j; i < count; ++i) {
          double* entry = to + 3 * (child.local_rows[i] - shift);
          entry[0] += from[3 * i];
          entry[1] += from[3 * i + 1];
          entry[2] += from[3 * i + 2];
        }
      }
    }
  }
}

bool BlockCholesky::factorise_front(const BlockMatrix& matrix, const Supernode& node, std::vector<int>& place) {
  assemble_front(matrix, node, place);
  const int k = 3 * node.columns, r = 3 * static_cast<int>(node.rows.size()), m = k + r;
  double* panel = factor_.data() + node.panel;
  double* update = stack_.data() + node.update;
  double* signs = signs_.data() + 3 * node.first;
  if (!factorise_panel(m, k, panel, signs)) return false;
  subtract_signed_square(r, k, panel + k, m, signs, update, r);
  return true;
}

bool BlockCholesky::factorise(const BlockMatrix& matrix, const std::function<void()>& ask) {
  std::vector<int> place(matrix.node_count());
  for (const Supernode& node : pattern_->nodes_) {
    ask();
    if (!factorise_front(matrix, node, place)) return false;
  }
  negative_pivots_ = static_cast<int>(std::count(signs_.begin(), signs_.end(), -1.0));
  return true;
}

void BlockCholesky::solve(Eigen::Ref<Eigen::MatrixXd> right_hand_sides) const {
  const Eigen::Index columns = right_hand_sides.cols();
  if (columns == 0) return;
  const std::vector<int>& order = pattern_->order_;
  Eigen::MatrixXd x(3 * static_cast<Eigen::Index>(order.size()), columns);
  for (Eigen::Index column = 0; column < columns; ++column)
    for (std::size_t i = 0; i < order.size(); ++i)
      copy_row(&right_hand_sides(3 * order[i], column), &x(3 * static_cast<Eigen::Index>(i), column));

  std::vector<double> front;
  for (const Supernode& node : pattern_->nodes_) solve_front(node, Half::lower, x, front);
  if (negative_pivots_ > 0) x = Eigen::Map<const Eigen::VectorXd>(signs_.data(), x.rows()).asDiagonal() * x;
  for (auto node = pattern_->nodes_.rbegin(); node != pattern_->nodes_.rend(); ++node)
    solve_front(*node, Half::upper, x, front);

  for (Eigen::Index column = 0; column < columns; ++column)
    for (std::size_t i = 0; i < order.size(); ++i)
      copy_row(&x(3 * static_cast<Eigen::Index>(i), column), &right_hand_sides(3 * order[i], column));
}

// In a copy of the rows that the front has: its columns, then what stands below them.
void BlockCholesky::solve_front(const Supernode& node, Half half, Eigen::MatrixXd& x,
                                std::vector<double>& front) const {
  const std::size_t k = 3 * static_cast<std::size_t>(node.columns), m = k + 3 * node.rows.size();
  front.resize(m * static_cast<std::size_t>(x.cols()));
  for (Eigen::Index column = 0; column < x.cols(); ++column) {
    double* const of = front.data() + m * static_cast<std::size_t>(column);
    const double* const from = &x(0, column);
    std::copy(from + 3 * node.first, from + 3 * node.first + k, of);
    std::fill(of + k, of + m, 0.0);
    if (half == Half::lower) continue;
    for (std::size_t i = 0; i < node.rows.size(); ++i) copy_row(from + 3 * node.rows[i], of + k + 3 * i);
  }
  const auto solve = half == Half::lower ? solve_panel : solve_panel_transposed;
  solve(static_cast<int>(m), static_cast<int>(k), factor_.data() + node.panel, static_cast<int>(x.cols()),
        front.data());
  for (Eigen::Index column = 0; column < x.cols(); ++column) {
    const double* const of = front.data() + m * static_cast<std::size_t>(column);
    double* const to = &x(0, column);
    std::copy(of, of + k, to + 3 * node.first);
    if (half == Half::upper) continue;
    for (std::size_t i = 0; i < node.rows.size(); ++i)
      for (int axis = 0; axis < 3; ++axis) to[3 * node.rows[i] + axis] += of[k + 3 * i + axis];
  }
}

}  // namespace soft_robot_lab
