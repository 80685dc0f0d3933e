// SPDX-License-Identifier: BSD-3-Clause
#include "perception/tracking/detection_fusion.h"

#include <gtest/gtest.h>

#include "drawn_scene.h"
#include "perception/tracking/marker_estimator.h"
#include "perception/tracking/marker_motion.h"

namespace soft_robot_lab {
namespace {

using test::camera_at;

const Eigen::Vector3d kPoint_m(0.01, -0.012, -0.03);

class DetectionFusion : public testing::Test {
 protected:
  MarkerDetection sight(const TrackerCamera& camera, const Eigen::Vector3d& point_m) const {
    const Eigen::Vector3d in_camera = camera.world_from_camera.inverse() * point_m;
    MarkerDetection sight;
    sight.camera = &camera;
    sight.pixel = camera.model.project(in_camera);
    sight.pixel_sigma = 0.05;
    sight.depth_m = in_camera.z();
    sight.depth_sigma_m = 5e-4;
    return sight;
  }
  // Where it is looked for: 6 mm off.
  MarkerPrediction prediction() const {
    return {kPoint_m + Eigen::Vector3d(0.004, -0.003, 0.003), Eigen::Vector3d::Zero(),
            2.5e-5 * Eigen::Matrix3d::Identity(), -1};
  }
  TrackerCamera left_ = camera_at("left", {-0.3, -0.52, 0.05}, {0, 0, -0.05});
  TrackerCamera right_ = camera_at("right", {0.3, -0.52, 0.05}, {0, 0, -0.05});
};

TEST_F(DetectionFusion, FindsThePointFromOneCameraAndFromTwo) {
  const auto one = fuse({sight(left_, kPoint_m)}, prediction());
  const auto two = fuse({sight(left_, kPoint_m), sight(right_, kPoint_m)}, prediction());
  ASSERT_TRUE(one && two);
  EXPECT_LT((one->position_m - kPoint_m).norm(), 1e-7);
  EXPECT_LT((two->position_m - kPoint_m).norm(), 1e-7);
  EXPECT_EQ(two->cameras, 2);
}

TEST_F(DetectionFusion, TwoCamerasMakeUpForDepthRoundedToMillimetres) {
  MarkerDetection left = sight(left_, kPoint_m), right = sight(right_, kPoint_m);
  *left.depth_m += 0.0005;
  *right.depth_m -= 0.0005;
  const auto fused = fuse({left, right}, prediction());
  ASSERT_TRUE(fused);
  EXPECT_LT((fused->position_m - kPoint_m).norm(), 5e-5);
}

TEST_F(DetectionFusion, WithoutDepthOneCameraKeepsThePredictedOne) {
  MarkerDetection left = sight(left_, kPoint_m);
  left.depth_m.reset();
  const auto fused = fuse({left}, prediction());
  ASSERT_TRUE(fused);
  const Eigen::Isometry3d from_world = left_.world_from_camera.inverse();
  EXPECT_NEAR((from_world * fused->position_m).z(), (from_world * prediction().position_m).z(), 2e-3);
  EXPECT_LT((left_.model.project(from_world * fused->position_m) - left.pixel).norm(), 1e-3);
  // Along the ray the filter's belief stays as uncertain as it was.
  MarkerMotion motion(prediction().position_m, 0.005);
  motion.correct(*fused);
  EXPECT_NEAR(motion.worst_sigma_m(), 0.005, 1e-4);
}

TEST_F(DetectionFusion, ComparesASightWithWhereTheMarkerIsThen) {
  const Eigen::Vector3d velocity_m_s(0.1, 0, -0.05);
  MarkerDetection right = sight(right_, kPoint_m + 0.02 * velocity_m_s);
  right.later_s = 0.02;
  MarkerPrediction moving = prediction();
  moving.velocity_m_s = velocity_m_s;
  const auto fused = fuse({sight(left_, kPoint_m), right}, moving);
  ASSERT_TRUE(fused);
  EXPECT_LT((fused->position_m - kPoint_m).norm(), 1e-6);
}

TEST_F(DetectionFusion, LeavesOutADepthThatBelongsToTheBackground) {
  MarkerDetection right = sight(right_, kPoint_m);
  *right.depth_m += 0.02;
  const auto fused = fuse_what_agrees({sight(left_, kPoint_m), right}, prediction(), 25);
  ASSERT_FALSE(fused.empty());
  EXPECT_LT((fused.front().position_m - kPoint_m).norm(), 1e-5);
  EXPECT_EQ(fused.front().cameras, 2);
}

TEST_F(DetectionFusion, LeavesOutACameraThatSeesSomethingElse) {
  const MarkerDetection wrong = sight(right_, kPoint_m + Eigen::Vector3d(0.02, 0.01, 0.03));
  const auto fused = fuse_what_agrees({sight(left_, kPoint_m), wrong}, prediction(), 25);
  ASSERT_FALSE(fused.empty());
  EXPECT_LT((fused.front().position_m - kPoint_m).norm(), 1e-5);
  EXPECT_EQ(fused.front().cameras, 1);
}

// Cameras that stand 3 mm from where they are said to, of which one has no depth of the marker: its ray alone agrees
// with any prediction that is near it, and says nothing of how far the marker is.
TEST_F(DetectionFusion, ARayAloneDoesNotLoseAMarkerThatAnotherCameraFixes) {
  MarkerDetection ray = sight(right_, kPoint_m + Eigen::Vector3d(0, 0, 0.003));
  ray.depth_m.reset();
  for (const double off_m : {0.0, 0.003, 0.006, 0.01}) {
    const Eigen::Vector3d expected_m = kPoint_m + Eigen::Vector3d(0.3, 0.52, 0.4).normalized() * off_m;
    MarkerEstimator estimator({}, {expected_m}, {-1});
    estimator.advance(1);
    estimator.correct({{sight(left_, kPoint_m), ray}});
    EXPECT_EQ(estimator.cameras(0), 1) << off_m;
    EXPECT_LT((estimator.motion(0).position_m() - kPoint_m).norm(), 1e-3) << off_m;
  }
}

TEST_F(DetectionFusion, SaysNothingWhereNothingAgreesWithThePrediction) {
  const Eigen::Vector3d far_m = kPoint_m + Eigen::Vector3d(0.05, 0, 0.05);
  EXPECT_TRUE(fuse_what_agrees({sight(left_, far_m), sight(right_, far_m)}, prediction(), 25).empty());
  EXPECT_TRUE(fuse_what_agrees({}, prediction(), 25).empty());
}

TEST(MarkerMotion, LearnsAConstantVelocity) {
  MarkerMotion motion(kPoint_m, 0.005);
  const Eigen::Vector3d velocity_m_s(0.05, -0.02, 0.01);
  FusedSights fused;
  fused.information_root = 1e4 * Eigen::Matrix3d::Identity();
  for (int frame = 1; frame <= 30; ++frame) {
    motion.predict(1 / 30.0, 2);
    fused.position_m = kPoint_m + frame / 30.0 * velocity_m_s;
    motion.correct(fused);
  }
  EXPECT_LT((motion.velocity_m_s() - velocity_m_s).norm(), 1e-3);
  EXPECT_LT((motion.position_m() - fused.position_m).norm(), 1e-5);
  EXPECT_LT(motion.worst_sigma_m(), 1.05e-4);
}

}  // namespace
}  // namespace soft_robot_lab
