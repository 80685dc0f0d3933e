// SPDX-License-Identifier: BSD-3-Clause
// What fuzzing found worth keeping, and its like.
#include <gtest/gtest.h>

#include "fuzz_rules.h"
#include "fuzz_scene.h"

namespace soft_robot_lab {
namespace {

TEST(SceneReader, SurvivesTheFuzzersCorpusAndItsLike) {
  EXPECT_GE(run_corpus(SOFT_ROBOT_LAB_SOURCE "/test/data/fuzz/scene", fuzz_scene, 10), 12);
}

}  // namespace
}  // namespace soft_robot_lab
