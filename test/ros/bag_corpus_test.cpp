// SPDX-License-Identifier: BSD-3-Clause
// What fuzzing found worth keeping, and its like.
#include <gtest/gtest.h>

#include "fuzz_rules.h"
#include "fuzz_bag.h"

namespace soft_robot_lab {
namespace {

TEST(BagReader, SurvivesTheFuzzersCorpusAndItsLike) {
  EXPECT_GE(run_corpus(SOFT_ROBOT_LAB_SOURCE "/test/data/fuzz/bag", fuzz_bag, 40), 8);
}

}  // namespace
}  // namespace soft_robot_lab
