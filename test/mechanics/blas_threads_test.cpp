// SPDX-License-Identifier: BSD-3-Clause
// A library that counts as OpenBLAS by this one function of its own.
#include <cstdlib>

#include <gtest/gtest.h>

#include "mechanics/linear_algebra/blas.h"

namespace {
int asked_threads = 0;
}

extern "C" void openblas_set_num_threads(int threads) { asked_threads = threads; }

namespace soft_robot_lab {
namespace {

TEST(Blas, HasItsLibraryUseOneThreadFromTheFirstCall) {
  unsetenv("OPENBLAS_NUM_THREADS");
  double four = 4.0;
  ASSERT_EQ(blas::cholesky(1, &four, 1), 0);
  EXPECT_EQ(four, 2.0);
  EXPECT_EQ(asked_threads, 1);
}

}  // namespace
}  // namespace soft_robot_lab
