// SPDX-License-Identifier: BSD-3-Clause
#include "perception/calibration/camera_tuning.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "ball_scene.h"
#include "perception/tracking/drawn_scene.h"

namespace soft_robot_lab {
namespace {

using test::draw_disc;
using test::plain_image;

const BallPlace kBall{{60.3, 40.8}, 20};

cv::Mat picture(double ball, double box, double blur_px = 0) {
  cv::Mat image = plain_image(120, 80, Eigen::Vector3d::Constant(box));
  draw_disc(image, kBall.centre_px, kBall.radius_px, Eigen::Vector3d::Constant(ball));
  if (blur_px > 0) cv::GaussianBlur(image, image, {}, blur_px);
  return image;
}

TEST(BallMeasure, MeasuresBallAndBoxInSharesOfWhite) {
  const BallMeasure measure = measure_balls(picture(204, 10), {kBall});
  EXPECT_NEAR(measure.darkest_level, 0.8, 0.003);
  EXPECT_NEAR(measure.brightest_level, 0.8, 0.003);
  EXPECT_NEAR(measure.box_level, 10.0 / 255, 1e-9);
  EXPECT_EQ(measure.saturated_share, 0);
}

TEST(BallMeasure, CountsWhitePixelsOfTheBallOnly) {
  cv::Mat image = picture(204, 10);
  image(cv::Rect(50, 30, 10, 10)) = cv::Scalar(255, 120, 120);  // white in a channel
  image(cv::Rect(0, 0, 5, 5)) = cv::Scalar::all(255);
  const double inner_px = M_PI * 16 * 16;
  EXPECT_NEAR(measure_balls(image, {kBall}).saturated_share, 100 / inner_px, 0.005);
}

// From 90 to 10 % a Gaussian's step is 2.563 deviations wide; a pixel, and reading between pixels, widen it a little.
TEST(BallMeasure, MeasuresHowWideTheEdgeIs) {
  const BallMeasure sharp = measure_balls(picture(204, 10), {kBall});
  ASSERT_TRUE(sharp.edge_width_px);
  EXPECT_LT(*sharp.edge_width_px, 1.6);
  for (double blur_px : {1.0, 1.5}) {
    const BallMeasure blurred = measure_balls(picture(204, 10, blur_px), {kBall});
    ASSERT_TRUE(blurred.edge_width_px);
    EXPECT_NEAR(*blurred.edge_width_px, 2.563 * std::hypot(blur_px, 0.5), 0.35) << blur_px;
  }
  EXPECT_FALSE(measure_balls(picture(40, 30), {kBall}).edge_width_px);
}

TEST(BallMeasure, TakesTheWorstOfSeveralBalls) {
  cv::Mat image = picture(204, 10);
  const BallPlace dim{{20, 20}, 10};
  draw_disc(image, dim.centre_px, dim.radius_px, Eigen::Vector3d::Constant(102));
  const BallMeasure both = measure_balls(image, {kBall, dim});
  EXPECT_NEAR(both.darkest_level, 0.4, 0.003);
  EXPECT_NEAR(both.brightest_level, 0.8, 0.003);
  EXPECT_NEAR(both.box_level, 10.0 / 255, 1e-9);
}

TEST(BallMeasure, RefusesWhatItCannotMeasure) {
  EXPECT_THROW(measure_balls(cv::Mat::zeros(80, 120, CV_8U), {kBall}), std::invalid_argument);
  EXPECT_THROW(measure_balls(picture(204, 10), {}), std::invalid_argument);
  EXPECT_THROW(measure_balls(picture(204, 10), {{{60, 40}, 4}}), std::invalid_argument);
  EXPECT_THROW(measure_balls(picture(204, 10), {{{60, 40}, NAN}}), std::invalid_argument);
  EXPECT_THROW(measure_balls(picture(204, 10), {{{160, 40}, 20}}), std::invalid_argument);
  EXPECT_THROW(measure_balls(picture(204, 10), {{{60, 40}, 200}}), std::invalid_argument);
}

// A camera and a light: levels are proportional to exposure and to 2^(gain / 32).
struct LinearCamera {
  double ball = 0.01, box = 0.0005;  // levels at an exposure of 1 and a gain of 0
  double edge_width_px = 2;
  double other_ball_ratio = 1;

  BallMeasure look(const CameraSetting& setting) const {
    const double light = setting.exposure * std::exp2(setting.gain / 32.0);
    BallMeasure measure;
    measure.darkest_level = std::min(1.0, other_ball_ratio * ball * light);
    measure.brightest_level = std::min(1.0, ball * light);
    measure.saturated_share = ball * light >= 250.0 / 255 ? 1 : 0;
    measure.box_level = std::min(1.0, box * light);
    measure.edge_width_px = edge_width_px;
    return measure;
  }
  CameraTuning tune(const TuningOptions& options = {}) const {
    return tune_camera(options, [&](const CameraSetting& setting) { return look(setting); });
  }
};

TEST(CameraTuning, FindsTheLongestExposureAtTheLeastGain) {
  const CameraTuning tuning = LinearCamera().tune();
  EXPECT_EQ(tuning.end, TuningEnd::crisp) << tuning.message;
  EXPECT_FALSE(tuning.setting.automatic);
  EXPECT_EQ(tuning.setting.gain, 0);
  EXPECT_LE(tuning.setting.exposure, 90);  // where the ball is at 90 %
  EXPECT_GE(tuning.setting.exposure, 85);
  EXPECT_LE(tuning.pictures, 12);
}

TEST(CameraTuning, GivesTheMeasureOfItsSetting) {
  const LinearCamera camera;
  const CameraTuning tuning = camera.tune();
  EXPECT_EQ(tuning.measure.brightest_level, camera.look(tuning.setting).brightest_level);
}

TEST(CameraTuning, TakesGainWhereTheLongestExposureIsTooShort) {
  LinearCamera camera;
  camera.ball = 0.001;
  camera.box = 0.00005;
  const CameraTuning tuning = camera.tune();
  EXPECT_EQ(tuning.end, TuningEnd::crisp) << tuning.message;
  EXPECT_EQ(tuning.setting.exposure, 300);
  EXPECT_NEAR(tuning.setting.gain, 32 * std::log2(0.9 / 0.3), 3);
}

TEST(CameraTuning, DarkensTheBallAsFarAsTheBoxAsks) {
  LinearCamera camera;
  camera.box = 0.002;  // a fifth of the ball
  const CameraTuning tuning = camera.tune();
  EXPECT_EQ(tuning.end, TuningEnd::crisp) << tuning.message;
  EXPECT_LE(tuning.measure.box_level, 0.12);
  EXPECT_NEAR(tuning.setting.exposure, 60, 3);
}

struct Refusal {
  LinearCamera camera;
  TuningEnd end;
  std::string words;
};

TEST(CameraTuning, SaysWhyItRefuses) {
  const std::vector<Refusal> table = {
      {{2, 0.01}, TuningEnd::ball_saturated, "too bright at the lowest settings"},
      {{0.5, 0.2}, TuningEnd::box_bright, "the box is too bright"},
      {{0.01, 0.005}, TuningEnd::box_bright, "the box is too bright"},
      {{1e-5, 1e-7}, TuningEnd::ball_dark, "too dark at the highest settings"},
      {{0.01, 0.0005, 2, 0.3}, TuningEnd::ball_dark, "another is as bright"},
      {{0.01, 0.0005, 6}, TuningEnd::blurred, "no sharp edge; allowed: 4 pixels"},
  };
  for (const Refusal& refusal : table) {
    const CameraTuning tuning = refusal.camera.tune();
    EXPECT_EQ(tuning.end, refusal.end) << tuning.message;
    EXPECT_NE(tuning.message.find(refusal.words), std::string::npos) << tuning.message;
  }
}

TEST(CameraTuning, EndsAfterSoManyPictures) {
  TuningOptions options;
  options.max_pictures = 3;
  const CameraTuning tuning = LinearCamera().tune(options);
  EXPECT_EQ(tuning.end, TuningEnd::out_of_pictures);
  EXPECT_EQ(tuning.pictures, 3);
}

TEST(CameraTuning, RefusesOptionsByNameAndRange) {
  const auto refusal = [](const auto& change) -> std::string {
    TuningOptions options;
    change(options);
    try {
      LinearCamera().tune(options);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "taken";
  };
  const auto refuses = [&](const std::string& field, const auto& change) {
    EXPECT_EQ(refusal(change).find(field + " is "), 0u) << refusal(change);
  };
  refuses("min_exposure", [](TuningOptions& o) { o.limits.min_exposure = 0; });
  refuses("max_exposure", [](TuningOptions& o) { o.limits = {200, 100, 0, 128}; });
  refuses("min_gain", [](TuningOptions& o) { o.limits.min_gain = -1; });
  refuses("max_gain", [](TuningOptions& o) { o.limits = {1, 300, 20, 10}; });
  refuses("max_level", [](TuningOptions& o) { o.max_level = 1.1; });
  refuses("min_level", [](TuningOptions& o) { o.min_level = 0.95; });
  refuses("max_saturated_share", [](TuningOptions& o) { o.max_saturated_share = NAN; });
  refuses("max_box_level", [](TuningOptions& o) { o.max_box_level = 0; });
  refuses("max_edge_width_px", [](TuningOptions& o) { o.max_edge_width_px = 0; });
  refuses("max_pictures", [](TuningOptions& o) { o.max_pictures = 0; });
}

// The rendered D415, whose noise grows with gain, before balls and a box that its own exposure shows far too bright.
class RenderedTuning : public testing::Test {
 protected:
  BallMeasure look(const CameraSetting& setting) {
    RigCamera camera = small_ball_camera(exposed(sensor, setting));
    const BallPictures pictures = film_balls(camera, room, {ball}, 1);
    const BallSearch search = find_balls(pictures.without, pictures.with, camera.model, BallFinderSettings());
    if (!place && search.balls.size() == 1) place = place_of(search.balls.front(), camera.model);
    if (!place) throw std::runtime_error("no ball");
    return measure_balls(pictures.with.front().colour, {*place});
  }

  SensorModel sensor = SensorModel::d415();
  Surroundings room = dark_room();
  Ball ball = ball_at(0.03, 0, 0.02);
  std::optional<BallPlace> place;
};

TEST_F(RenderedTuning, MakesAnOverexposedBallCrispAndItsBoxDark) {
  sensor.exposure_gain = 3;
  const BallMeasure before = look({});
  EXPECT_GT(before.saturated_share, 0.5);
  EXPECT_NEAR(place->radius_px, small_ball_camera(sensor).model.focal_x_px * 0.02 / 0.4, 1);
  const CameraTuning tuning = tune_camera({}, [&](const CameraSetting& setting) { return look(setting); });
  EXPECT_EQ(tuning.end, TuningEnd::crisp) << tuning.message;
  EXPECT_LT(exposed(sensor, tuning.setting).exposure_gain, sensor.exposure_gain);
  EXPECT_EQ(tuning.setting.gain, 0) << "there is light enough, and gain brings noise";
  EXPECT_LT(tuning.measure.box_level, before.box_level);
}

}  // namespace
}  // namespace soft_robot_lab
