// SPDX-License-Identifier: BSD-3-Clause
#include "session/held_target.h"

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

TEST(HeldTarget, IsHeldUntilTheHandLetsGo) {
  HeldTarget target;
  EXPECT_FALSE(target.held(0.0));
  target.take(10.0);
  EXPECT_TRUE(target.held(10.0));
  target.let_go();
  EXPECT_FALSE(target.held(10.0));
}

TEST(HeldTarget, IsLetGoOfByAWindowThatIsGone) {
  HeldTarget target;
  target.take(10.0);
  for (double now_s = 10.5; now_s < 20.0; now_s += 0.5) {
    EXPECT_TRUE(target.held(now_s)) << "it says so while it holds it";
    target.keep(now_s);
  }
  EXPECT_TRUE(target.held(21.4));
  EXPECT_FALSE(target.held(21.6));
  target.keep(21.7);
  EXPECT_FALSE(target.held(21.7)) << "what is heard of a target that is not held takes no hold of it";
  target.take(30.0);
  EXPECT_TRUE(target.held(31.0));
}

}  // namespace
}  // namespace soft_robot_lab
