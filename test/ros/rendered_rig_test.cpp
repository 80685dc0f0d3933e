// SPDX-License-Identifier: BSD-3-Clause
#include "ros/cameras/rendered_rig.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "seen_messages.h"

namespace soft_robot_lab {
namespace {

// One small camera at 10 Hz, and a ball to calibrate it.
RenderedRig small_rig() {
  return RenderedRig(read_camera_setup(SOFT_ROBOT_LAB_SOURCE "/test/data/cameras/bar.yaml"), 1);
}

SeenRobotStates robot_at(double stamp_s) {
  SeenRobotStates robot;
  robot.add_markers(markers(stamp_s));
  robot.add_surface(surface(stamp_s));
  return robot;
}

// Whether a picture was taken.
bool film(RenderedRig& rig, SeenRobotStates& robot, double stamp_s, bool wanted = true) {
  robot.add_markers(markers(stamp_s, stamp_s));
  robot.add_surface(surface(stamp_s, stamp_s));
  return !rig.take_due(robot, [&](std::size_t) { return wanted; }).empty();
}

cv::Mat picture(RenderedRig& rig, double stamp_s) {
  return rig.take_due(robot_at(stamp_s), [](std::size_t) { return true; }).at(0).frame.colour;
}

TEST(RenderedRig, FilmsAtItsRateOfSessionTime) {
  RenderedRig rig = small_rig();
  SeenRobotStates robot;
  EXPECT_TRUE(rig.take_due(robot, [](std::size_t) { return true; }).empty());
  EXPECT_TRUE(film(rig, robot, 0.1));
  EXPECT_FALSE(film(rig, robot, 0.15));
  EXPECT_TRUE(film(rig, robot, 0.2));
  EXPECT_FALSE(film(rig, robot, 0.299));
  EXPECT_TRUE(film(rig, robot, 0.3));
  EXPECT_EQ(rig.counts(0).taken, 3);
  EXPECT_EQ(rig.counts(0).dropped, 0);
  EXPECT_GT(rig.counts(0).cpu_s, 0);
}

TEST(RenderedRig, CountsFramesThatItHadNoTimeFor) {
  RenderedRig rig = small_rig();
  SeenRobotStates robot;
  EXPECT_TRUE(film(rig, robot, 0.1));
  EXPECT_TRUE(film(rig, robot, 0.45));
  EXPECT_EQ(rig.counts(0).dropped, 2);
  EXPECT_FALSE(film(rig, robot, 0.5, false));
  EXPECT_FALSE(film(rig, robot, 1.5, false));
  EXPECT_TRUE(film(rig, robot, 2.0));
  EXPECT_EQ(rig.counts(0).dropped, 2);  // nobody wanted those between
}

TEST(RenderedRig, FilmsOnWhenTimeGoesBack) {
  RenderedRig rig = small_rig();
  SeenRobotStates robot;
  EXPECT_TRUE(film(rig, robot, 50));
  EXPECT_TRUE(film(rig, robot, 1));
  EXPECT_EQ(rig.counts(0).dropped, 0);
}

TEST(RenderedRig, ShowsAndHidesTheBallsAndKeepsTheRobot) {
  RenderedRig rig = small_rig();
  const cv::Mat without = picture(rig, 1).clone();
  rig.show_balls(true);
  const cv::Mat with = picture(rig, 2).clone();
  rig.show_balls(false);
  EXPECT_GT(cv::norm(without, with, cv::NORM_INF), 200);
  EXPECT_EQ(cv::norm(without, picture(rig, 3), cv::NORM_INF), 0);
}

TEST(RenderedRig, AddsUpMoves) {
  RenderedRig rig = small_rig();
  const Eigen::Isometry3d before = rig.cameras()[0].pose.world_from_camera;
  rig.move("eye", {0.01, 0, 0}, {0, 0, 0.1});
  const RigCamera& camera = rig.move("eye", {0.01, 0, 0}, {0, 0, 0.1});
  EXPECT_NEAR((camera.pose.world_from_camera.translation() - before.translation()).x(), 0.02, 1e-15);
  const Eigen::AngleAxisd turned(camera.pose.world_from_camera.linear() * before.linear().transpose());
  EXPECT_NEAR(turned.angle(), 0.2, 1e-12);
  EXPECT_NEAR(turned.axis().z(), 1, 1e-12);
  EXPECT_THROW(rig.move("nose", {0, 0, 0}, {0, 0, 0}), std::invalid_argument);
  EXPECT_THROW(rig.move("eye", {0, NAN, 0}, {0, 0, 0}), std::invalid_argument);
  EXPECT_THROW(rig.move("eye", {0, 0, 0}, {0, 0, INFINITY}), std::invalid_argument);
}

// Sums and products of what lies farther away are no numbers, and end what renders.
TEST(RenderedRig, StaysWhereItCanFilm) {
  RenderedRig rig = small_rig();
  SeenRobotStates robot;
  double stamp_s = 0.1;
  for (const double far : {1e4, 1e19, 1e154, 1e300, -1e19}) {
    EXPECT_THROW(rig.move("eye", {far, 0, 0}, {0, 0, 0}), std::invalid_argument) << far;
    EXPECT_THROW(rig.move("eye", {0, 0, 0}, {0, 10 * far, 0}), std::invalid_argument) << far;
    EXPECT_TRUE(film(rig, robot, stamp_s += 0.1));
  }
  rig.move("eye", {900, 0, 0}, {0, 0, 0});
  EXPECT_TRUE(film(rig, robot, stamp_s += 0.1));
  const Eigen::Isometry3d there = rig.cameras()[0].pose.world_from_camera;
  EXPECT_THROW(rig.move("eye", {900, 0, 0}, {0, 0, 1}), std::invalid_argument) << "a small step that leads too far";
  EXPECT_TRUE(rig.cameras()[0].pose.world_from_camera.isApprox(there, 0.0));
  EXPECT_TRUE(film(rig, robot, stamp_s += 0.1));
}

}  // namespace
}  // namespace soft_robot_lab
