// SPDX-License-Identifier: BSD-3-Clause
#include "settings/quantile.h"

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

TEST(Quantile, IsOneOfTheValues) {
  const std::vector<double> values = {5.0, 1.0, 4.0, 2.0, 3.0};
  EXPECT_EQ(quantile(values, 0.0), 1.0);
  EXPECT_EQ(quantile(values, 0.3), 2.0);
  EXPECT_EQ(quantile(values, 0.4), 3.0);
  EXPECT_EQ(quantile(values, 1.0), 5.0);
  EXPECT_EQ(quantile({7.0}, 0.9), 7.0);
}

TEST(Quantile, OfAHalfIsTheMedianOrTheUpperOfTwo) {
  EXPECT_EQ(median({5.0, 1.0, 3.0}), 3.0);
  EXPECT_EQ(median({4.0, 1.0, 3.0, 2.0}), 3.0);
  EXPECT_EQ(median({1.0, 2.0}), 2.0);
}

}  // namespace
}  // namespace soft_robot_lab
