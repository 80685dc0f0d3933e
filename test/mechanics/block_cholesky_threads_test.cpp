// SPDX-License-Identifier: BSD-3-Clause
// Several threads factorise at once, each with a factor of its own.
#include <atomic>
#include <memory>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "mechanics/linear_algebra/block_cholesky.h"

namespace soft_robot_lab {
namespace {

constexpr int kThreads = 4;
constexpr int kRounds = 3000;

// A chain of 40 nodes, each coupled with the next three; positive definite.
BlockMatrix chain() {
  constexpr int kNodes = 40;
  std::vector<std::vector<int>> cliques;
  for (int i = 0; i + 3 < kNodes; ++i) cliques.push_back({i, i + 1, i + 2, i + 3});
  BlockMatrix matrix(kNodes, cliques);
  for (int slot = 0; slot < static_cast<int>(matrix.rows().size()); ++slot)
    for (int i = 0; i < 9; ++i) matrix.block(slot)[i] = 0.01 * ((7 * slot + 3 * (i % 3) + 3 * (i / 3)) % 11);
  for (int i = 0; i < kNodes; ++i) matrix.add_to_diagonal(i, 5.0);
  return matrix;
}

Eigen::MatrixXd solution(const BlockMatrix& matrix, const std::shared_ptr<const FactorPattern>& pattern) {
  BlockCholesky factor(pattern);
  if (!factor.factorise(matrix)) return {};
  Eigen::MatrixXd x = Eigen::MatrixXd::Ones(3 * matrix.node_count(), 7);
  factor.solve(x);
  return x;
}

TEST(BlockCholesky, GivesTheSameBitsInSeveralThreadsAtOnce) {
  const BlockMatrix matrix = chain();
  const auto pattern = std::make_shared<const FactorPattern>(matrix.pattern());
  const Eigen::MatrixXd alone = solution(matrix, pattern);
  ASSERT_GT(alone.size(), 0);
  std::atomic<int> others{0};
  std::vector<std::thread> threads;
  for (int i = 0; i < kThreads; ++i)
    threads.emplace_back([&] {
      for (int round = 0; round < kRounds; ++round)
        if (solution(matrix, pattern) != alone) ++others;
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(others, 0) << "of " << kThreads * kRounds;
}

}  // namespace
}  // namespace soft_robot_lab
