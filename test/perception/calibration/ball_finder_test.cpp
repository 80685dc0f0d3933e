// SPDX-License-Identifier: BSD-3-Clause
#include "perception/calibration/ball_finder.h"

#include <cmath>
#include <functional>
#include <stdexcept>

#include <Eigen/LU>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "ball_scene.h"

namespace soft_robot_lab {
namespace {

BallSearch find(const std::vector<Ball>& balls, const SensorModel& sensor = {}, int count = 1,
                const BallFinderSettings& settings = {}) {
  const RigCamera camera = small_ball_camera(sensor);
  const BallPictures pictures = film_balls(camera, dark_room(), balls, 1, count);
  return find_balls(pictures.without, pictures.with, camera.model, settings);
}

Eigen::Vector3d in_camera(const Ball& ball) {
  return small_ball_camera({}).pose.world_from_camera.inverse() * ball.center_m;
}

const std::vector<Ball> two_balls{ball_at(-0.11, 0, 0.06), ball_at(0.06, 0.05, -0.03)};

void expect_rejected(const BallSearch& search, const std::string& reason) {
  ASSERT_EQ(search.rejected.size(), 1u);
  EXPECT_NE(search.rejected[0].find(reason), std::string::npos) << search.rejected[0];
}

TEST(BallFinder, FindsBallsFromLeftToRight) {
  const BallSearch search = find({two_balls[1], two_balls[0]});
  ASSERT_EQ(search.balls.size(), 2u);
  EXPECT_TRUE(search.rejected.empty());
  for (std::size_t i = 0; i < 2; ++i) {
    const Eigen::Vector3d miss = search.balls[i].center_m - in_camera(two_balls[i]);
    const Eigen::Vector3d ray = in_camera(two_balls[i]).normalized();
    EXPECT_LT((miss - miss.dot(ray) * ray).norm(), 0.00005);
    EXPECT_LT(std::abs(miss.dot(ray)), 0.0001);
    EXPECT_NEAR(search.balls[i].radius_m, 0.02, 0.0005);
    EXPECT_LT(search.balls[i].depth_residual_m, 0.0004);  // of millimetres: 0.29 mm
  }
}

TEST(BallFinder, KnowsHowWrongItIsInNoise) {
  for (int count : {1, 3}) {
    const BallSearch search = find(two_balls, SensorModel::d415(), count);
    ASSERT_EQ(search.balls.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
      const Eigen::Vector3d miss = search.balls[i].center_m - in_camera(two_balls[i]);
      EXPECT_LT(miss.norm(), 0.0008);
      EXPECT_LT(miss.dot(search.balls[i].covariance_m2.inverse() * miss), 16);  // three degrees of freedom
      EXPECT_LT(search.balls[i].covariance_m2.trace(), 0.002 * 0.002);
    }
  }
}

TEST(BallFinder, SeesThroughALens) {
  RigCamera camera = small_ball_camera({});
  camera.model.distortion = {0.08, -0.1, 0.001, -0.001, 0};
  const BallPictures pictures = film_balls(camera, dark_room(), two_balls, 1);
  const BallSearch search = find_balls(pictures.without, pictures.with, camera.model, {});
  ASSERT_EQ(search.balls.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_LT((search.balls[i].center_m - in_camera(two_balls[i])).norm(), 0.00015);
}

TEST(BallFinder, TellsABallOfAnotherRadius) {
  const BallSearch search = find({two_balls[0], ball_at(0.06, 0, 0, 0.025)}, SensorModel::d415());
  EXPECT_EQ(search.balls.size(), 1u);
  expect_rejected(search, "allowed: 20 mm within 10 %");
}

TEST(BallFinder, TellsBallsThatTouch) {
  const BallSearch search = find({two_balls[0], ball_at(0.04, 0, 0), ball_at(0.08, 0, 0)});
  EXPECT_EQ(search.balls.size(), 1u);
  expect_rejected(search, "is not one ball");
}

TEST(BallFinder, TellsABallThatIsCutByTheImagesEdge) {
  const BallSearch search = find({two_balls[0], ball_at(0.274, 0, 0)});
  EXPECT_EQ(search.balls.size(), 1u);
  expect_rejected(search, "of its outline");
}

TEST(BallFinder, TellsABallWithoutDepth) {
  const RigCamera camera = small_ball_camera({});
  BallPictures pictures = film_balls(camera, dark_room(), two_balls, 1);
  pictures.with[0].depth_m.colRange(212, 424).setTo(0);
  const BallSearch search = find_balls(pictures.without, pictures.with, camera.model, {});
  EXPECT_EQ(search.balls.size(), 1u);
  expect_rejected(search, "has only 0 depths");
}

TEST(BallFinder, FindsNothingWhereNothingChanged) {
  const BallSearch search = find({}, SensorModel::d415());
  EXPECT_TRUE(search.balls.empty());
  EXPECT_TRUE(search.rejected.empty());
}

TEST(BallFinder, RefusesPicturesItCannotCompare) {
  const RigCamera camera = small_ball_camera({});
  const BallPictures good = film_balls(camera, dark_room(), {}, 1);
  const std::function<void(BallPictures&)> spoil[] = {
      [](BallPictures& pictures) { pictures.without.clear(); },
      [](BallPictures& pictures) { pictures.with.clear(); },
      [](BallPictures& pictures) { pictures.with[0].depth_m = pictures.with[0].depth_m.colRange(0, 400).clone(); },
      [](BallPictures& pictures) { pictures.without[0].colour = cv::Mat(480, 848, CV_8UC3, cv::Scalar::all(0)); },
      [](BallPictures& pictures) { pictures.with[0].colour = cv::Mat(240, 424, CV_8UC1, cv::Scalar(0)); },
      [](BallPictures& pictures) { pictures.with[0].depth_m = cv::Mat(240, 424, CV_16UC1, cv::Scalar(0)); },
  };
  EXPECT_NO_THROW(find_balls(good.without, good.with, camera.model, {}));
  for (const auto& wrong : spoil) {
    BallPictures pictures = good;
    wrong(pictures);
    EXPECT_THROW(find_balls(pictures.without, pictures.with, camera.model, {}), std::invalid_argument);
  }
}

TEST(BallFinder, RefusesWrongSettings) {
  const std::function<void(BallFinderSettings&)> spoil[] = {
      [](BallFinderSettings& settings) { settings.radius_m = 0; },
      [](BallFinderSettings& settings) { settings.radius_tolerance = 0.5; },
      [](BallFinderSettings& settings) { settings.colour_change = std::nan(""); },
      [](BallFinderSettings& settings) { settings.depth_change_m = -0.01; },
      [](BallFinderSettings& settings) { settings.min_points = 3; },
      [](BallFinderSettings& settings) { settings.min_sphere_share = 1.1; },
      [](BallFinderSettings& settings) { settings.min_outline_share = 0; },
      [](BallFinderSettings& settings) { settings.edge_noise_px = 0; },
      [](BallFinderSettings& settings) { settings.outline_bias_px = 0; },
      [](BallFinderSettings& settings) { settings.depth_bias = -1; },
      [](BallFinderSettings& settings) { settings.depth.correlation_px = 0; },
  };
  EXPECT_NO_THROW(BallFinderSettings{}.validate());
  for (const auto& wrong : spoil) {
    BallFinderSettings settings;
    wrong(settings);
    EXPECT_THROW(settings.validate(), std::invalid_argument);
  }
}

}  // namespace
}  // namespace soft_robot_lab
