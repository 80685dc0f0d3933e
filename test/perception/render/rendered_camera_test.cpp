// SPDX-License-Identifier: BSD-3-Clause
#include "perception/render/rendered_camera.h"

#include <cmath>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "seen_things.h"

namespace soft_robot_lab {
namespace {

// One frame of something at rest.
RgbdFrame take(const Seen& seen, const SensorModel& sensor, double distance_m, std::uint64_t seed = 1,
               std::uint64_t frame = 0) {
  RayScene scene = seen.scene();
  RenderedCamera camera("camera", ExactCamera(small_camera(), facing_pose(distance_m), scene), sensor, seed);
  return camera.take(scene, {seen.state, {}, 0}, 1.5, frame);
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

double deviation_m(const cv::Mat& depth_m) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(depth_m, mean, deviation);
  return deviation[0];
}

TEST(RenderedCamera, IsExactUnlessToldOtherwise) {
  Seen seen = facing_wall();
  add_sticker(seen, {0, 0, 0});
  const RgbdFrame frame = take(seen, {}, 0.6004);
  EXPECT_EQ(frame.camera, "camera");
  EXPECT_EQ(frame.stamp_s, 1.5);
  EXPECT_EQ(frame.colour.type(), CV_8UC3);
  EXPECT_EQ(frame.depth_m.type(), CV_32FC1);
  EXPECT_EQ(cv::countNonZero(frame.depth_m != 0.6F), 0);
  EXPECT_EQ(frame.depth_step_m, 0.001);
  EXPECT_EQ(frame.colour.at<cv::Vec3b>(10, 10), cv::Vec3b(255, 255, 255));
  const RgbdFrame again = take(seen, {}, 0.6004, 2, 5);  // no noise, so neither seed nor frame matter
  EXPECT_TRUE(same(frame.colour, again.colour));
  EXPECT_TRUE(same(frame.depth_m, again.depth_m));
}

// Of a slope of 2 in 3 that every ray meets elsewhere.
Seen slope() {
  Seen seen;
  seen.surroundings.lighting.shaded = false;
  add_rectangle(seen, {-1, -1, -1.5}, {2, 0, 0}, {0, 2, 3});
  return seen;
}

double slope_depth_m(int row) {  // y = 2/3 z
  const double down = (row - small_camera().centre_y_px) / small_camera().focal_y_px;
  return 0.6 / (1 + 2 * down / 3);
}

TEST(RenderedCamera, GivesDepthsOfItsRaysWhereTheyAreNotRounded) {
  SensorModel sensor;
  sensor.depth_step_m = 0;
  const RgbdFrame frame = take(slope(), sensor, 0.6);
  EXPECT_EQ(frame.depth_step_m, 0);
  for (int row = 0; row < frame.depth_m.rows; ++row)
    for (int column = 0; column < frame.depth_m.cols; ++column)
      ASSERT_NEAR(frame.depth_m.at<float>(row, column), slope_depth_m(row), 1e-6) << row << ' ' << column;
}

TEST(RenderedCamera, RoundsDepthsToTheSensorsStep) {
  SensorModel sensor;
  sensor.depth_step_m = 0.0025;
  const cv::Mat depth_m = take(slope(), sensor, 0.6).depth_m;
  for (int row = 0; row < depth_m.rows; ++row) {
    const double steps = std::round(slope_depth_m(row) / 0.0025);
    if (std::abs(slope_depth_m(row) / 0.0025 - steps) > 0.499) continue;  // rays are not as exact as that
    ASSERT_NEAR(depth_m.at<float>(row, 100), 0.0025 * steps, 1e-7) << row;
  }
  sensor.disparity_noise_px = 0.08;
  const cv::Mat noisy_m = take(slope(), sensor, 0.6).depth_m;
  for (int row = 0; row < noisy_m.rows; ++row) {
    const double steps = static_cast<double>(noisy_m.at<float>(row, 100)) / 0.0025;
    ASSERT_NEAR(steps, std::round(steps), 1e-4) << row;
  }
}

TEST(RenderedCamera, KeepsItsNoiseWhereDepthsAreNotRounded) {
  SensorModel sensor = SensorModel::d415();
  const cv::Mat rounded_m = take(slope(), sensor, 0.6).depth_m;
  sensor.depth_step_m = 0;
  const cv::Mat depth_m = take(slope(), sensor, 0.6).depth_m;
  EXPECT_LT(cv::norm(depth_m, rounded_m, cv::NORM_INF), 0.000501);
  EXPECT_GT(cv::norm(depth_m, rounded_m, cv::NORM_INF), 0.0004);
  EXPECT_EQ(cv::countNonZero((depth_m == 0) != (rounded_m == 0)), 0);
}

TEST(RenderedCamera, MeasuresNothingWhereNothingIsMet) {
  SensorModel sensor = SensorModel::d415();
  for (const double step_m : {0.001, 0.0}) {
    sensor.depth_step_m = step_m;
    EXPECT_EQ(cv::countNonZero(take({}, sensor, 0.6).depth_m), 0);
  }
}

TEST(RenderedCamera, RepeatsItsNoiseFromSeedAndFrameOnly) {
  Seen seen = facing_wall();
  seen.robot.colour.setConstant(0.6);
  const SensorModel sensor = SensorModel::d415();
  const RgbdFrame first = take(seen, sensor, 0.6, 1, 7);
  EXPECT_TRUE(same(first.colour, take(seen, sensor, 0.6, 1, 7).colour));
  EXPECT_TRUE(same(first.depth_m, take(seen, sensor, 0.6, 1, 7).depth_m));
  for (const RgbdFrame& other : {take(seen, sensor, 0.6, 2, 7), take(seen, sensor, 0.6, 1, 8)}) {
    EXPECT_FALSE(same(first.colour, other.colour));
    EXPECT_FALSE(same(first.depth_m, other.depth_m));
  }
}

TEST(RenderedCamera, DrawsEachFrameAsIfItWereTheFirst) {
  Seen seen = facing_wall(0.05, 0.05);
  seen.surroundings.cuboids.push_back({{-1, -1, -1}, {1, 1, 1}, {0.2, 0.2, 0.2}});
  RayScene scene = seen.scene();
  const ExactCamera exact(small_camera(), facing_pose(0.6), scene);
  RenderedCamera used("camera", exact, SensorModel::d415(), 1), fresh("camera", exact, SensorModel::d415(), 1);
  SeenState moved = seen.state;
  moved.vertices_m.row(0).array() += 0.05;
  used.take(scene, {moved, {}, 0}, 0, 0);
  const RgbdFrame expected = fresh.take(scene, {seen.state, {}, 0}, 0, 1);
  const RgbdFrame frame = used.take(scene, {seen.state, {}, 0}, 0, 1);
  EXPECT_TRUE(same(frame.colour, expected.colour));
  EXPECT_TRUE(same(frame.depth_m, expected.depth_m));
}

TEST(DepthNoise, GrowsWithTheSquareOfDistance) {
  SensorModel sensor;
  sensor.disparity_noise_px = 2;  // large, lest rounding to millimetres matters
  sensor.noise_correlation_px = 1;
  const double focal_px = 0.5 * 212 / std::tan(0.5 * 65 * M_PI / 180);
  for (double distance_m : {0.4, 0.6, 0.8}) {
    const double expected_m = distance_m * distance_m * 2 / (focal_px * 0.055);
    EXPECT_NEAR(deviation_m(take(facing_wall(), sensor, distance_m).depth_m) / expected_m, 1, 0.1 + expected_m);
  }
}

TEST(DepthNoise, HangsTogetherOverPixelsAsFarAsAsked) {
  SensorModel sensor;
  sensor.disparity_noise_px = 2;
  const auto correlation = [&](double length_px, int apart_px) {
    sensor.noise_correlation_px = length_px;
    cv::Mat depth = take(facing_wall(), sensor, 0.4).depth_m;
    depth -= cv::mean(depth)[0];
    const cv::Mat left = depth.colRange(0, depth.cols - apart_px), right = depth.colRange(apart_px, depth.cols);
    return left.dot(right) / left.dot(left);
  };
  EXPECT_NEAR(correlation(0, 1), 0, 0.05);
  EXPECT_NEAR(correlation(2, 2), std::exp(-0.25), 0.05);  // exp(-d^2 / (4 s^2))
  EXPECT_NEAR(correlation(2, 12), 0, 0.06);
}

TEST(DepthNoise, QuantisesDisparity) {
  Seen seen;
  add_rectangle(seen, {-1, -0.2, -1}, {2, 0.4, 0}, {0, 0, 2});  // its depth falls from left to right
  SensorModel sensor;
  sensor.disparity_step_px = 0.5;
  const RgbdFrame frame = take(seen, sensor, 0.6);
  const double focal_baseline = 0.5 * 212 / std::tan(0.5 * 65 * M_PI / 180) * 0.055;
  std::set<float> depths_m(frame.depth_m.begin<float>(), frame.depth_m.end<float>());
  ASSERT_GT(depths_m.size(), 3u);
  for (const float depth_m : depths_m) {
    const double steps = focal_baseline / static_cast<double>(depth_m) / 0.5;
    EXPECT_NEAR(focal_baseline / (0.5 * std::round(steps)), depth_m, 0.00051);
  }
}

Seen before_a_wall() {
  Seen seen = facing_wall(0.06, 0.06);
  seen.robot.colour.setConstant(0.8);
  seen.surroundings.cuboids.push_back({{-2, 0.4, -2}, {2, 0.5, 2}, {0.8, 0.8, 0.8}});
  return seen;
}

TEST(DepthHoles, LieAlongEdges) {
  SensorModel sensor;
  sensor.edge_hole_px = 2;
  const cv::Mat depth = take(before_a_wall(), sensor, 0.6).depth_m;
  const double half_px = 0.03 / 0.6 * small_camera().focal_x_px;  // 30.6
  EXPECT_EQ(depth.at<float>(60, 106), 0.6F);
  EXPECT_EQ(depth.at<float>(60, static_cast<int>(105.5 + half_px)), 0);
  EXPECT_EQ(depth.at<float>(60, static_cast<int>(105.5 + half_px) + 2), 0);
  EXPECT_EQ(depth.at<float>(60, static_cast<int>(105.5 + half_px) - 4), 0.6F);
  EXPECT_EQ(depth.at<float>(60, static_cast<int>(105.5 + half_px) + 5), 1);
  EXPECT_EQ(depth.at<float>(5, 5), 1);
}

TEST(DepthHoles, LieInTheSecondImagersShadow) {
  SensorModel sensor;
  sensor.stereo_shadow = true;
  const cv::Mat depth = take(before_a_wall(), sensor, 0.6).depth_m;
  const double focal_px = 0.5 * 212 / std::tan(0.5 * 65 * M_PI / 180);
  const double shadow_px = focal_px * 0.055 * (1 / 0.6 - 1 / 1.0);  // left of what is near
  const int row = 60, left_edge = static_cast<int>(std::ceil(105.5 - 0.03 / 0.6 * small_camera().focal_x_px));
  const cv::Mat holes = depth.row(row) == 0;
  EXPECT_NEAR(cv::countNonZero(holes), shadow_px, 1.5);
  EXPECT_EQ(cv::countNonZero(holes.colRange(0, left_edge)), cv::countNonZero(holes));
}

TEST(DepthHoles, BlotOutTheDark) {
  SensorModel sensor;
  sensor.low_texture_level = 0.1;
  sensor.noise_correlation_px = 1.5;
  Seen seen = facing_wall();
  const auto hole_ratio = [&](double brightness) {
    seen.robot.colour.setConstant(brightness);
    const cv::Mat depth = take(seen, sensor, 0.6).depth_m;
    return 1 - cv::countNonZero(depth) / static_cast<double>(depth.total());
  };
  EXPECT_NEAR(hole_ratio(0), 0.5, 0.05);
  EXPECT_NEAR(hole_ratio(0.1 / 3), 0.16, 0.05);  // beyond one deviation
  EXPECT_EQ(hole_ratio(0.11), 0);
}

TEST(ColourNoise, IsThatOfPhotons) {
  SensorModel sensor;
  sensor.electrons_at_white = 1000;
  Seen seen = facing_wall();
  for (double brightness : {0.2, 0.7}) {
    seen.robot.colour.setConstant(brightness);
    cv::Scalar mean, deviation;
    cv::meanStdDev(take(seen, sensor, 0.6).colour, mean, deviation);
    EXPECT_NEAR(mean[0], 255 * brightness, 0.5);
    EXPECT_NEAR(deviation[0] / (255 * std::sqrt(brightness / 1000)), 1, 0.05);
  }
}

TEST(Light, FollowsGainAndGradient) {
  SensorModel sensor;
  sensor.exposure_gain = 1.5;
  sensor.light_gradient = 0.5;
  Seen seen = facing_wall();
  seen.robot.colour.setConstant(0.4);
  const cv::Mat colour = take(seen, sensor, 0.6).colour;
  EXPECT_EQ(colour.at<cv::Vec3b>(60, 0)[0], 153);
  EXPECT_NEAR(colour.at<cv::Vec3b>(60, 211)[0], 153 * (1 - 0.5 * 211 / 212), 1);
}

TEST(Light, MirrorsLampsOnSiliconeOnly) {
  Seen seen = facing_wall();
  add_sticker(seen, {0.05, 0, 0}, 0.02);
  seen.robot.colour.setConstant(0.4);
  seen.surroundings.lighting.shaded = true;
  seen.surroundings.lighting.lights.push_back({{0, -0.6, 0}, 0.5});
  SensorModel sensor;
  const cv::Mat matt = take(seen, sensor, 0.6).colour;
  sensor.gloss = 0.5;
  const cv::Mat glossy = take(seen, sensor, 0.6).colour;
  EXPECT_NEAR(glossy.at<cv::Vec3b>(60, 105)[0] - matt.at<cv::Vec3b>(60, 105)[0], 0.25 * 255, 2);
  EXPECT_EQ(glossy.at<cv::Vec3b>(60, 156), matt.at<cv::Vec3b>(60, 156));
}

TEST(Exposure, BrightensWithItsLengthAndDoublesEvery32StepsOfGain) {
  Seen seen = facing_wall();
  seen.robot.colour.setConstant(0.2);
  const SensorModel sensor;
  const auto level = [&](const CameraSetting& setting) {
    return cv::mean(take(seen, exposed(sensor, setting), 0.6).colour)[0];
  };
  const double own = level(own_setting(sensor));
  EXPECT_NEAR(own, 51, 0.5);
  EXPECT_NEAR(level({false, 166, 64}), own, 0.5);
  EXPECT_NEAR(level({false, 332, 64}), 2 * own, 1);
  EXPECT_NEAR(level({false, 83, 64}), 0.5 * own, 1);
  EXPECT_NEAR(level({false, 166, 96}), 2 * own, 1);
  EXPECT_NEAR(level({false, 166, 0}), 0.25 * own, 1);
  EXPECT_NEAR(level({true, 332, 128}), own, 0.5) << "what is automatic is the camera's own affair";
}

TEST(Exposure, GainMakesNoiseBrighterThanALongerExposureDoes) {
  Seen seen = facing_wall();
  seen.robot.colour.setConstant(0.2);
  SensorModel sensor;
  sensor.electrons_at_white = 1000;
  sensor.read_noise = 0.01;
  const auto noise = [&](const CameraSetting& setting) {
    cv::Scalar mean, deviation;
    cv::meanStdDev(take(seen, exposed(sensor, setting), 0.6).colour, mean, deviation);
    EXPECT_NEAR(mean[0], 102, 1);
    return deviation[0] / 255;
  };
  EXPECT_NEAR(noise({false, 332, 64}) / std::sqrt(0.4 / 1000 + 1e-4), 1, 0.05);
  EXPECT_NEAR(noise({false, 166, 96}) / std::sqrt(0.4 / 500 + 4e-4), 1, 0.05);
}

TEST(Exposure, SmearsForAsLongAsItIsWhereItSmearsAtAll) {
  EXPECT_EQ(own_setting(SensorModel::d415()).exposure, 80);
  EXPECT_NEAR(exposed(SensorModel::d415(), {false, 200, 64}).exposure_time_s, 0.02, 1e-12);
  EXPECT_EQ(exposed(SensorModel(), {false, 200, 64}).exposure_time_s, 0);
}

TEST(Exposure, RefusesWhatNoD415Takes) {
  EXPECT_THROW(exposed({}, {false, 0, 64}), std::invalid_argument);
  EXPECT_THROW(exposed({}, {false, 10001, 64}), std::invalid_argument);
  EXPECT_THROW(exposed({}, {false, 166, -1}), std::invalid_argument);
  EXPECT_THROW(exposed({}, {false, 166, 129}), std::invalid_argument);
}

// A white board, 1 m/s to the right, before black.
struct MovingBoard {
  Seen seen = facing_wall(0.05, 2);
  SeenMotion motion;
  MovingBoard() {
    motion.present = motion.before = seen.state;
    motion.before.vertices_m.row(0).array() -= 0.01;
    motion.interval_s = 0.01;
  }
  double edge_px(const SensorModel& sensor, int row) const {  // where the left edge is: by the light right of it
    RayScene scene = seen.scene();
    RenderedCamera camera("camera", ExactCamera(small_camera(), facing_pose(0.6), scene), sensor, 1);
    const cv::Mat colour = camera.take(scene, motion, 0, 0).colour;
    double light = 0;
    for (int u = 0; u < 106; ++u) light += colour.at<cv::Vec3b>(row, u)[0] / 255.0;
    return 105.5 - light;
  }
};

TEST(RollingShutter, ShowsLaterRowsLater) {
  SensorModel sensor;
  sensor.readout_time_s = 0.02;
  const MovingBoard board;
  const double px_per_s = small_camera().focal_x_px / 0.6;
  const double middle_px = board.edge_px({}, 60);
  EXPECT_NEAR(board.edge_px(sensor, 60), middle_px, 0.6);
  EXPECT_NEAR(board.edge_px(sensor, 0) - middle_px, -0.01 * px_per_s, 0.6);
  EXPECT_NEAR(board.edge_px(sensor, 119) - middle_px, 0.01 * px_per_s, 0.6);
}

TEST(MotionBlur, SmearsWhatMoves) {
  SensorModel sensor;
  sensor.exposure_time_s = 0.008;
  const MovingBoard board;
  RayScene scene = board.seen.scene();
  RenderedCamera camera("camera", ExactCamera(small_camera(), facing_pose(0.6), scene), sensor, 1);
  const auto grey_count = [](const cv::Mat& colour) {
    int count = 0;
    for (int u = 0; u < 106; ++u) count += colour.at<cv::Vec3b>(60, u)[0] > 5 && colour.at<cv::Vec3b>(60, u)[0] < 250;
    return count;
  };
  const double smear_px = 0.008 * small_camera().focal_x_px / 0.6;
  EXPECT_NEAR(grey_count(camera.take(scene, board.motion, 0, 0).colour), smear_px, 1.5);
  EXPECT_LE(grey_count(camera.take(scene, {board.seen.state, {}, 0}, 0, 0).colour), 1);
  EXPECT_NEAR(board.edge_px(sensor, 60), board.edge_px({}, 60), 0.1);  // about the stamp
}

TEST(Blur, SpreadsEdges) {
  SensorModel sensor;
  sensor.blur_px = 2;
  const cv::Mat colour = take(facing_wall(0.05, 2), sensor, 0.6).colour;
  const double edge_px = 105.5 - 0.025 / 0.6 * small_camera().focal_x_px;
  const int u = static_cast<int>(std::ceil(edge_px));
  const double expected = 0.5 * std::erfc(-(u - edge_px) / 2 / std::sqrt(2.0));
  EXPECT_NEAR(colour.at<cv::Vec3b>(60, u)[0] / 255.0, expected, 0.02);
}

TEST(RenderedCamera, RefusesMotionsThatDoNotMatch) {
  const Seen seen = facing_wall();
  RayScene scene = seen.scene();
  RenderedCamera camera("camera", ExactCamera(small_camera(), facing_pose(0.6), scene), SensorModel::d415(), 1);
  EXPECT_THROW(camera.take(scene, {seen.state, {}, 0.01}, 0, 0), std::invalid_argument);
  EXPECT_THROW(camera.take(scene, {seen.state, seen.state, -1}, 0, 0), std::invalid_argument);
  SeenState more = seen.state, before = seen.state;
  more.stickers_m.conservativeResize(3, more.stickers_m.cols() + 1);
  more.stickers_m.rightCols<1>().setZero();
  before.stickers_m = more.stickers_m;
  before.vertices_m.array() += 0.01;
  EXPECT_THROW(camera.take(scene, {more, before, 0.01}, 0, 0), std::invalid_argument);
}

}  // namespace
}  // namespace soft_robot_lab
