// SPDX-License-Identifier: BSD-3-Clause
#include "study/experiments/grasp.h"

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

const ExperimentContext kContext{SOFT_ROBOT_LAB_SOURCE "/config", "", SOFT_ROBOT_LAB_MESHER, {}};

GraspTask task() {
  GraspTask task;
  task.scene = kContext.config_folder + "/robots/gripper/ball.yaml";
  task.contraction = 0.92;
  task.lift_m = 0.03;
  task.amplitude_m = 0.01;
  task.frequency_hz = 5.0;
  return task;
}

TEST(Grasp, NeedsFrictionForWeightAndShaking) {
  LiftedBall lifted;
  lifted.mass_kg = 0.1;
  lifted.gravity_m_s2 = 10.0;
  lifted.squeeze_n = 4.0;  // two fingers of 2 N
  EXPECT_DOUBLE_EQ(lifted.least_friction(0.0), 0.25);
  EXPECT_DOUBLE_EQ(lifted.least_friction(6.0), 0.4);
  EXPECT_NEAR(task().acceleration_m_s2(), 9.8696, 1e-4);
}

TEST(Grasp, HoldsABallByFrictionAndDropsItWithoutEnough) {
  const LiftedBall lifted = lift_ball(kContext, task(), 0.5);
  ASSERT_TRUE(lifted.converged);
  EXPECT_NEAR(lifted.state.contact.free.centers_m(2, 0), -0.067 + 0.03 + 0.003, 0.001);  // both fingers shorten
  const double least = lifted.least_friction(task().acceleration_m_s2());
  EXPECT_GT(0.5, 1.2 * least);

  const ShakenBall held = shake_ball(kContext, task(), lifted, 0.5, 1.4);
  EXPECT_TRUE(held.converged);
  EXPECT_TRUE(held.held);
  EXPECT_LT(held.slip_m, 1e-5);
  EXPECT_LT(held.moved_m, 1e-5);

  const ShakenBall dropped = shake_ball(kContext, task(), lifted, 0.7 * least, 1.4);
  EXPECT_TRUE(dropped.converged);
  EXPECT_FALSE(dropped.held);
}

}  // namespace
}  // namespace soft_robot_lab
