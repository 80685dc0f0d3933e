// SPDX-License-Identifier: BSD-3-Clause
// Whatever happens to the line, the plug and the board: the position is exact or declared unknown.
#include <gtest/gtest.h>

#include "study/rig/fault_run.h"

namespace soft_robot_lab {
namespace {

TEST(FaultRun, EndsExactOrDeclaredUnknownWithEveryCommandAccountedFor) {
  FaultRunOptions options;
  options.commands = 2000;  // the experiment, which the nightly suite runs, sends ten thousand
  options.emulator = SOFT_ROBOT_LAB_RIG_EMULATOR;
  const FaultRunResult result =
      run_with_faults(load_rig(SOFT_ROBOT_LAB_SOURCE "/config/robots/spinebot/motors.yaml"), options);
  EXPECT_EQ(result.commands, 2000);
  EXPECT_EQ(result.unplugs, 10);
  EXPECT_EQ(result.resets, 3);
  EXPECT_EQ(result.wrong_unflagged, 0);
  EXPECT_EQ(result.unaccounted, 0);
  EXPECT_EQ(result.stuck, 0);
  // That faults did come, and commands did pass: the ten unplugs and three resets take more of so short a run.
  EXPECT_GT(result.checks, 15);
  EXPECT_EQ(result.unknown_declared, 2);  // both motors, after the brown-out
  EXPECT_GT(result.acknowledged, 500);
  EXPECT_GT(result.corrupted, 500);
  EXPECT_GT(result.lost, 500);
  EXPECT_GT(result.doubled, 500);
}

}  // namespace
}  // namespace soft_robot_lab
