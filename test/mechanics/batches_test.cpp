// SPDX-License-Identifier: BSD-3-Clause
#include "mechanics/linear_algebra/batches.h"

#include <cstdint>
#include <memory>

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

// As the copies of the kernels for AVX2 read and write them.
TEST(Batches, LieAtMultiplesOfTheirSizeWhateverElseIsAllocated) {
  std::vector<Batches> all;
  std::vector<std::unique_ptr<char[]>> others;
  for (std::size_t i = 1; i < 100; ++i) {
    all.emplace_back(i, splat(1.0));
    others.push_back(std::make_unique<char[]>(16 * i));
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(all.back().data()) % sizeof(Batch), 0u) << i;
  }
}

}  // namespace
}  // namespace soft_robot_lab
