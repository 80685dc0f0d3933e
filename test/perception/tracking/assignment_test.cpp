// SPDX-License-Identifier: BSD-3-Clause
#include "perception/tracking/assignment.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

double cost_of(const Eigen::MatrixXd& costs, const std::vector<int>& column_of, double cost_of_none) {
  double sum = 0;
  for (std::size_t i = 0; i < column_of.size(); ++i)
    sum += column_of[i] < 0 ? cost_of_none : costs(static_cast<Eigen::Index>(i), column_of[i]);
  return sum;
}

double least_cost(const Eigen::MatrixXd& costs, double cost_of_none) {
  // Columns beyond the last stand for none.
  std::vector<int> order(costs.cols() + costs.rows());
  std::iota(order.begin(), order.end(), 0);
  double least = std::numeric_limits<double>::infinity();
  do {
    std::vector<int> column_of(order.begin(), order.begin() + costs.rows());
    for (int& column : column_of)
      if (column >= costs.cols()) column = -1;
    least = std::min(least, cost_of(costs, column_of, cost_of_none));
  } while (std::next_permutation(order.begin(), order.end()));
  return least;
}

TEST(Assignment, CostsNoMoreThanTheBestOfAllPermutations) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int round = 0; round < 60; ++round) {
    const Eigen::MatrixXd costs =
        Eigen::MatrixXd::NullaryExpr(1 + round % 4, 1 + (round / 4) % 4, [&] { return uniform(random); });
    const double cost_of_none = 0.6 * uniform(random);
    const std::vector<int> column_of = assign(costs, cost_of_none);
    std::vector<int> used;
    for (const int column : column_of)
      if (column >= 0) used.push_back(column);
    std::sort(used.begin(), used.end());
    EXPECT_EQ(std::adjacent_find(used.begin(), used.end()), used.end());
    EXPECT_NEAR(cost_of(costs, column_of, cost_of_none), least_cost(costs, cost_of_none), 1e-12);
  }
}

TEST(Assignment, NeverChoosesTheInfinite) {
  const double infinity = std::numeric_limits<double>::infinity();
  Eigen::MatrixXd costs(2, 2);
  costs << infinity, 1, infinity, 2;
  EXPECT_EQ(assign(costs, 10), (std::vector<int>{1, -1}));
  EXPECT_EQ(assign(Eigen::MatrixXd(2, 0), 10), (std::vector<int>{-1, -1}));
  EXPECT_TRUE(assign(Eigen::MatrixXd(0, 3), 10).empty());
}

TEST(Assignment, RefusesWhatIsNotANumber) {
  Eigen::MatrixXd costs = Eigen::MatrixXd::Zero(2, 2);
  costs(1, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(assign(costs, 1), std::invalid_argument);
}

}  // namespace
}  // namespace soft_robot_lab
