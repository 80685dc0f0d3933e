// SPDX-License-Identifier: BSD-3-Clause
#include "block_cholesky.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <sstream>
#include <stdexcept>

#include "blas.h"

namespace soft_robot_lab {
namespace {

using blas::Side;
using blas::Transposed;

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

constexpr int kBlock = 64;  // columns at a time

// The lower triangle of a k x k matrix to L with A = L S L'; false at a pivot that all but vanishes.
bool signed_cholesky(double* a, int k, int ld, double* signs) {
  double largest = 0.0;
  for (int j = 0; j < k; ++j) largest = std::max(largest, std::abs(a[j * (ld + 1)]));
  for (int j = 0; j < k; ++j) {
    double* column = a + static_cast<std::ptrdiff_t>(j) * ld;
    const double pivot = column[j];
    if (!(std::abs(pivot) > 1e-13 * largest) || !std::isfinite(pivot)) return false;
    signs[j] = pivot > 0.0 ? 1.0 : -1.0;
    column[j] = std::sqrt(std::abs(pivot));
    for (int i = j + 1; i < k; ++i) column[i] *= signs[j] / column[j];
    for (int c = j + 1; c < k; ++c)
      for (int i = c; i < k; ++i) a[static_cast<std::ptrdiff_t>(c) * ld + i] -= signs[j] * column[c] * column[i];
  }
  return true;
}

// The same for up to kBlock columns, by LAPACK where S is 1.
bool factorise_block(double* a, int k, int ld, double* signs) {
  using Block = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kBlock, kBlock>;
  Eigen::Map<Block, 0, Eigen::OuterStride<>> block(a, k, k, Eigen::OuterStride<>(ld));
  const Block before = block;
  std::fill(signs, signs + k, 1.0);
  // NaN slips through some implementations' pivot test.
  if (blas::cholesky(k, a, ld) == 0 && block(k - 1, k - 1) > 0.0) return true;
  block = before;
  return signed_cholesky(a, k, ld, signs);
}

// With L and S of k columns: what stands below them, A21 (rows x k), to L21 = A21 L^-T S, and A22 -= L21 S L21'.
void eliminate(const double* l, int k, int ld, const double* signs, double* below, int rows, double* rest,
               int ld_rest) {
  if (rows == 0) return;
  blas::solve_triangular(Side::right, Transposed::yes, rows, k, l, ld, below, ld);
  blas::subtract_square(rows, k, below, ld, rest, ld_rest);
  for (int j = 0; j < k; ++j) {
    if (signs[j] > 0.0) continue;
    double* column = below + static_cast<std::ptrdiff_t>(j) * ld;
    blas::add_outer(rows, 2.0, column, rest, ld_rest);
    std::transform(column, column + rows, column, std::negate<double>());
  }
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

BlockCholesky::BlockCholesky(std::shared_ptr<const FactorPattern> pattern)
    : pattern_(std::move(pattern)),
      nodes_(pattern_->nodes_),
      order_(pattern_->order_),
      factor_(static_cast<std::size_t>(pattern_->factor_size_)),
      stack_(static_cast<std::size_t>(pattern_->stack_size_)),
      signs_(3 * order_.size(), 1.0) {}

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
    const Supernode& child = nodes_[child_index];
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
  for (int first = 0; first < k; first += kBlock) {
    const int columns = std::min(kBlock, k - first), left = k - first - columns;
    double* block = panel + static_cast<std::ptrdiff_t>(first) * (m + 1);
    double* rest = block + static_cast<std::ptrdiff_t>(columns) * (m + 1);
    if (!factorise_block(block, columns, m, signs + first)) return false;
    eliminate(block, columns, m, signs + first, block + columns, left, rest, m);
  }
  eliminate(panel, k, m, signs, panel + k, r, update, r);
  return true;
}

bool BlockCholesky::factorise(const BlockMatrix& matrix) {
  std::vector<int> place(matrix.node_count());
  for (const Supernode& node : nodes_)
    if (!factorise_front(matrix, node, place)) return false;
  negative_pivots_ = static_cast<int>(std::count(signs_.begin(), signs_.end(), -1.0));
  return true;
}

void BlockCholesky::solve(Eigen::Ref<Eigen::MatrixXd> right_hand_sides) const {
  const int columns = static_cast<int>(right_hand_sides.cols());
  const int size = 3 * static_cast<int>(order_.size());
  if (columns == 0) return;
  Eigen::MatrixXd x(size, columns), below;
  for (std::size_t i = 0; i < order_.size(); ++i)
    x.middleRows(3 * static_cast<Eigen::Index>(i), 3) = right_hand_sides.middleRows(3 * order_[i], 3);

  for (const Supernode& node : nodes_) {
    const int k = 3 * node.columns, r = 3 * static_cast<int>(node.rows.size()), m = k + r;
    const double* panel = factor_.data() + node.panel;
    double* top = x.data() + 3 * node.first;
    blas::solve_triangular(Side::left, Transposed::no, k, columns, panel, m, top, size);
    if (r == 0) continue;
    below.resize(r, columns);
    blas::multiply(Transposed::no, r, columns, k, 1.0, panel + k, m, top, size, 0.0, below.data(), r);
    for (std::size_t i = 0; i < node.rows.size(); ++i)
      x.middleRows(3 * node.rows[i], 3) -= below.middleRows(3 * static_cast<Eigen::Index>(i), 3);
  }
  if (negative_pivots_ > 0) x = Eigen::Map<const Eigen::VectorXd>(signs_.data(), size).asDiagonal() * x;
  for (auto node = nodes_.rbegin(); node != nodes_.rend(); ++node) {
    const int k = 3 * node->columns, r = 3 * static_cast<int>(node->rows.size()), m = k + r;
    const double* panel = factor_.data() + node->panel;
    double* top = x.data() + 3 * node->first;
    if (r > 0) {
      below.resize(r, columns);
      for (std::size_t i = 0; i < node->rows.size(); ++i)
        below.middleRows(3 * static_cast<Eigen::Index>(i), 3) = x.middleRows(3 * node->rows[i], 3);
      blas::multiply(Transposed::yes, k, columns, r, -1.0, panel + k, m, below.data(), r, 1.0, top, size);
    }
    blas::solve_triangular(Side::left, Transposed::yes, k, columns, panel, m, top, size);
  }

  for (std::size_t i = 0; i < order_.size(); ++i)
    right_hand_sides.middleRows(3 * order_[i], 3) = x.middleRows(3 * static_cast<Eigen::Index>(i), 3);
}

}  // namespace soft_robot_lab
