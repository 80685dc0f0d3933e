// SPDX-License-Identifier: BSD-3-Clause
// The factor of a sparse matrix, its dense panels, and several threads that factorise at once.
#include <atomic>
#include <limits>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "mechanics/linear_algebra/block_cholesky.h"
#include "mechanics/linear_algebra/panel_kernels.h"

namespace soft_robot_lab {
namespace {

constexpr int kThreads = 4;
constexpr int kRounds = 3000;

// Symmetric, with a large diagonal of both signs: every third is negative.
Eigen::MatrixXd indefinite(int size) {
  Eigen::MatrixXd a(size, size);
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) a(i, j) = 0.1 * ((7 * (i + j) + 3 * i * j) % 11 - 5);
  for (int i = 0; i < size; ++i) a(i, i) = (i % 3 == 2 ? -1.0 : 1.0) * (size + 1.0);
  return a;
}

// A panel of k columns and what stands to the right of it, eliminated.
struct Eliminated {
  Eigen::MatrixXd panel, rest;
  Eigen::VectorXd signs;
  bool done;

  Eliminated(const Eigen::MatrixXd& a, int k)
      : panel(a.leftCols(k)), rest(a.bottomRightCorner(a.rows() - k, a.rows() - k)), signs(k) {
    const int m = static_cast<int>(a.rows());
    done = factorise_panel(m, k, panel.data(), signs.data());
    subtract_signed_square(m - k, k, panel.data() + k, m, signs.data(), rest.data(), m - k);
  }
  Eigen::MatrixXd lower() const {
    Eigen::MatrixXd l = Eigen::MatrixXd::Identity(panel.rows(), panel.rows());
    l.leftCols(panel.cols()) = panel;
    l.topLeftCorner(panel.cols(), panel.cols()).triangularView<Eigen::StrictlyUpper>().setZero();
    return l;
  }
};

TEST(Panels, EliminateColumnsOfIndefiniteMatricesOfAnySize) {
  for (const auto& [k, below] :
       std::vector<std::pair<int, int>>{{1, 0}, {3, 2}, {6, 7}, {21, 40}, {130, 75}, {9, 210}}) {
    const Eigen::MatrixXd a = indefinite(k + below);
    const Eliminated result(a, k);
    ASSERT_TRUE(result.done) << k;
    Eigen::MatrixXd middle = Eigen::MatrixXd::Zero(a.rows(), a.rows());
    middle.topLeftCorner(k, k) = result.signs.asDiagonal();
    middle.bottomRightCorner(below, below) = result.rest.selfadjointView<Eigen::Lower>();
    const Eigen::MatrixXd l = result.lower();
    EXPECT_LT((l * middle * l.transpose() - a).cwiseAbs().maxCoeff(), 1e-12 * a.rows()) << k << " " << below;
    EXPECT_EQ((result.signs.array() < 0.0).count(), k / 3) << k;
  }
}

TEST(Panels, SolveBothWaysForSeveralColumns) {
  constexpr int kColumns = 23, kRows = 50;
  const Eliminated result(indefinite(kRows), kColumns);
  const Eigen::MatrixXd l = result.lower(), b = indefinite(kRows).leftCols(3);
  Eigen::MatrixXd x = b, y = b;
  solve_panel(kRows, kColumns, result.panel.data(), 3, x.data());
  solve_panel_transposed(kRows, kColumns, result.panel.data(), 3, y.data());
  EXPECT_LT((l * x - b).cwiseAbs().maxCoeff(), 1e-11);
  EXPECT_LT((l.transpose() * y - b).cwiseAbs().maxCoeff(), 1e-11);
}

TEST(Panels, RefusePivotsThatVanishOrAreNotFinite) {
  for (const double pivot : {0.0, -1e-15, std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()}) {
    Eigen::MatrixXd a = Eigen::MatrixXd::Identity(9, 9);
    a(5, 5) = pivot;
    EXPECT_FALSE(Eliminated(a, 6).done) << pivot;
  }
}

// A chain of nodes, each coupled with the next three; positive definite.
BlockMatrix chain(int count = 40) {
  std::vector<std::vector<int>> cliques;
  for (int i = 0; i + 3 < count; ++i) cliques.push_back({i, i + 1, i + 2, i + 3});
  BlockMatrix matrix(count, cliques);
  for (int slot = 0; slot < static_cast<int>(matrix.rows().size()); ++slot)
    for (int i = 0; i < 9; ++i) matrix.block(slot)[i] = 0.01 * ((7 * slot + 3 * (i % 3) + 3 * (i / 3)) % 11);
  for (int i = 0; i < count; ++i) matrix.add_to_diagonal(i, 5.0);
  return matrix;
}

Eigen::MatrixXd solution(const BlockMatrix& matrix, BlockCholesky factor) {
  if (!factor.factorise(matrix)) return {};
  Eigen::MatrixXd x = Eigen::MatrixXd::Ones(3 * matrix.node_count(), 7);
  factor.solve(x);
  return x;
}

TEST(BlockCholesky, GivesTheSameBitsInSeveralThreadsAtOnce) {
  const BlockMatrix matrix = chain();
  const auto pattern = std::make_shared<const FactorPattern>(matrix.pattern());
  const Eigen::MatrixXd alone = solution(matrix, BlockCholesky(pattern));
  ASSERT_GT(alone.size(), 0);
  std::atomic<int> others{0};
  std::vector<std::thread> threads;
  for (int i = 0; i < kThreads; ++i)
    threads.emplace_back([&] {
      for (int round = 0; round < kRounds; ++round)
        if (solution(matrix, BlockCholesky(pattern)) != alone) ++others;
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(others, 0) << "of " << kThreads * kRounds;
}

TEST(BlockCholesky, GoesOnWithOtherPatternsAsOneThatIsNew) {
  const BlockMatrix first = chain();
  BlockCholesky factor(first);
  ASSERT_TRUE(factor.factorise(first));
  for (const int count : {60, 25, 40}) {
    const BlockMatrix next = chain(count);
    factor.follow(std::make_shared<const FactorPattern>(next.pattern()));
    const Eigen::MatrixXd expected = solution(next, BlockCholesky(next));
    ASSERT_GT(expected.size(), 0) << count;
    EXPECT_EQ(solution(next, factor), expected) << count;
  }
}

// Where that ends it, the next factor is as one that is new.
TEST(BlockCholesky, AsksBeforeEachFrontWhetherToEnd) {
  const BlockMatrix matrix = chain(200);
  BlockCholesky factor(matrix);
  int asked = 0;
  ASSERT_TRUE(factor.factorise(matrix, [&] { ++asked; }));
  ASSERT_GT(asked, 2);
  EXPECT_LE(asked, matrix.node_count());
  int left = asked / 2;
  const auto ask = [&] {
    if (left-- == 0) throw std::runtime_error("ended");
  };
  EXPECT_THROW(factor.factorise(matrix, ask), std::runtime_error);
  EXPECT_EQ(solution(matrix, factor), solution(matrix, BlockCholesky(matrix)));
}

}  // namespace
}  // namespace soft_robot_lab
