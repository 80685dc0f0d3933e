// SPDX-License-Identifier: BSD-3-Clause
// Sparse factor L S L' of a BlockMatrix, S = diag(+-1), by the multifrontal method (Duff & Reid 1983; Liu 1992), dense
// fronts by panel_kernels.h. A Cholesky factor where the matrix is positive definite; else S counts its negative
// eigenvalues. There is no pivoting: a body held in an unstable shape by its cables is indefinite in a few directions,
// not ill-conditioned.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "block_matrix.h"
#include "settings/limits.h"

namespace soft_robot_lab {

constexpr double kMostMemory_gb =
    limits::kMemory_gb;  // that a body may take: a machine that runs out of it ends other programs first

// What is known of the factors of all matrices of one pattern; they share it.
class FactorPattern {
 public:
  // Symbolic analysis, once per pattern. Throws std::invalid_argument where a factor would take more than
  // kMostMemory_gb.
  explicit FactorPattern(const BlockPattern& matrix);

  double flops() const { return flops_; }                      // of one factorisation
  std::ptrdiff_t factor_size() const { return factor_size_; }  // doubles stored

 private:
  friend class BlockCholesky;

  // Consecutive columns that share one row structure.
  struct Supernode {
    int first = 0, columns = 0;   // block columns first .. first + columns - 1
    std::vector<int> rows;        // block rows below them, ascending positions
    std::vector<int> children;    // supernodes whose update is added to this front
    std::vector<int> local_rows;  // place of each of `rows` in the parent's front (parent's columns, then its rows)
    std::ptrdiff_t panel = 0;     // start of its (columns + rows) x columns dense panel in the factor
    std::ptrdiff_t update = 0;    // start of its rows x rows update matrix on the stack
  };

  void merge_columns(const BlockPattern& matrix);

  std::vector<Supernode> nodes_;
  std::vector<int> order_;  // position -> mesh node
  double flops_ = 0.0;
  std::ptrdiff_t factor_size_ = 0, stack_size_ = 0;
};

class BlockCholesky {
 public:
  explicit BlockCholesky(std::shared_ptr<const FactorPattern> pattern);
  explicit BlockCholesky(const BlockMatrix& matrix)
      : BlockCholesky(std::make_shared<const FactorPattern>(matrix.pattern())) {}

  // Goes on with matrices of another pattern, in the same memory.
  void follow(std::shared_ptr<const FactorPattern> pattern);

  // False when a pivot vanishes or is not finite; the factor is then not usable. `ask` comes before each front, of
  // which there are fewer than nodes, and may throw; likewise.
  bool factorise(
      const BlockMatrix& matrix, const std::function<void()>& ask = [] {});

  int negative_pivots() const { return negative_pivots_; }  // 0: positive definite

  // Solves in place for right-hand sides given as columns over 3*node + axis.
  void solve(Eigen::Ref<Eigen::MatrixXd> right_hand_sides) const;

  double flops() const { return pattern_->flops(); }
  std::ptrdiff_t factor_size() const { return pattern_->factor_size(); }

 private:
  using Supernode = FactorPattern::Supernode;

  enum class Half { lower, upper };  // L, L'
  void solve_front(const Supernode& node, Half half, Eigen::MatrixXd& x, std::vector<double>& front) const;
  bool factorise_front(const BlockMatrix& matrix, const Supernode& node, std::vector<int>& place);
  void assemble_front(const BlockMatrix& matrix, const Supernode& node, std::vector<int>& place);

  std::shared_ptr<const FactorPattern> pattern_;
  std::vector<double> factor_, stack_;
  std::vector<double> signs_;  // S, per scalar column
  int negative_pivots_ = 0;
};

}  // namespace soft_robot_lab
