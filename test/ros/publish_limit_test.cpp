// SPDX-License-Identifier: BSD-3-Clause
#include "ros/base/publish_limit.h"

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

// Of `steps` time steps, each of which takes `machine_step_s`.
int published(double time_step_s, double machine_step_s, int steps) {
  PublishLimit limit(1000.0);
  int count = 0;
  double session_s = 0.0;
  for (int i = 0; i < steps; ++i) {
    session_s += time_step_s;
    count += limit.due(session_s, machine_step_s * i);
  }
  return count;
}

TEST(PublishLimit, PassesEveryStepOfAMillisecondOrMore) {
  EXPECT_EQ(published(0.005, 5.0e-5, 10000), 10000);  // at a hundred times real time
  EXPECT_EQ(published(0.001, 1.0e-5, 10000), 10000);
}

TEST(PublishLimit, PassesAThousandStatesASecondOfTinySteps) {
  EXPECT_NEAR(published(1.0e-9, 1.0 / 31000.0, 31000), 1000, 50);
  EXPECT_NEAR(published(1.0e-5, 1.0e-7, 100000), 1000, 50);  // of a session faster than real time: in its own second
}

TEST(PublishLimit, PassesSlowStepsHoweverSmall) { EXPECT_EQ(published(1.0e-9, 0.01, 100), 100); }

TEST(PublishLimit, GoesOnWhereTheClockIsSet) {
  PublishLimit limit(1000.0);
  for (const double session_s : {1.8e9, 4.0e9, 0.0, 1.8e9}) {
    EXPECT_TRUE(limit.due(session_s, 1.0));
    EXPECT_FALSE(limit.due(session_s, 1.0));
  }
}

}  // namespace
}  // namespace soft_robot_lab
