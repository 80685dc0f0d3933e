// SPDX-License-Identifier: BSD-3-Clause
// What fuzzing found worth keeping, and its like.
#include <gtest/gtest.h>

#include "fuzz_rules.h"
#include "fuzz_mesh.h"
#include "fuzz_vtk.h"

namespace soft_robot_lab {
namespace {

TEST(MeshReaders, SurvivesTheFuzzersCorpusAndItsLike) {
  EXPECT_GE(run_corpus(SOFT_ROBOT_LAB_SOURCE "/test/data/fuzz/mesh", fuzz_mesh, 40), 5);
  EXPECT_GE(run_corpus(SOFT_ROBOT_LAB_SOURCE "/test/data/fuzz/vtk", fuzz_vtk, 40), 4);
}

}  // namespace
}  // namespace soft_robot_lab
