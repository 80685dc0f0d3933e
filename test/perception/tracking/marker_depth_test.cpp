// SPDX-License-Identifier: BSD-3-Clause
#include "perception/tracking/marker_depth.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "drawn_scene.h"
#include "perception/tracking/marker_detection.h"

namespace soft_robot_lab {
namespace {

using namespace test;

// A marker of radius 4 px at pixel (20.3, 19.6) on a plane with 0.6 m there and slopes [m/px].
struct Plane {
  double slope_x = 0, slope_y = 0;
  double depth_m(double x, double y) const { return 0.6 + slope_x * (x - 20.3) + slope_y * (y - 19.6); }
};

MarkerBlob blob() {
  cv::Mat image = plain_image(40, 40, kSkin);
  draw_disc(image, {20.3, 19.6}, 4, kBlue);
  DetectorSettings settings;
  settings.colours = {{"blue", {{200, 260, 0.45, 1, 0.12, 1}}}};
  return detect_markers(image, {0, 0, 40, 40}, settings).at(0);
}

// Rounded to `step_m`; 0: not.
cv::Mat depth_image(const Plane& plane, double noise_m = 0, unsigned seed = 1, double step_m = 0.001) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, 1);
  cv::Mat depth(40, 40, CV_32F);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x) {
      const double depth_m = plane.depth_m(x, y) + noise_m * normal(random);
      depth.at<float>(y, x) = static_cast<float>(step_m > 0 ? step_m * std::round(depth_m / step_m) : depth_m);
    }
  return depth;
}

TEST(MarkerDepth, TakesATiltedPlaneAtTheCentre) {
  for (const Plane& plane : {Plane{}, Plane{0.00083, 0}, Plane{-0.0007, 0.0011}}) {
    const auto depth = measure_depth(depth_image(plane), blob(), {});
    ASSERT_TRUE(depth);
    EXPECT_NEAR(depth->depth_m, 0.6, 1e-4) << plane.slope_x;
    EXPECT_NEAR(depth->slope_m_px, std::hypot(plane.slope_x, plane.slope_y), 1e-4);
    EXPECT_FALSE(depth->cut);
  }
}

TEST(MarkerDepth, IsAsExactAsDepthsThatAreNotRounded) {
  DepthSettings not_rounded;
  not_rounded.quantisation_m = 0;
  const MarkerBlob marker = blob();
  const cv::Mat depth_m = depth_image({0.0002, 0}, 0, 1, 0);
  const auto rounded = measure_depth(depth_m, marker, {}), exact = measure_depth(depth_m, marker, not_rounded);
  ASSERT_TRUE(rounded && exact);
  EXPECT_NEAR(exact->depth_m, 0.6, 1e-6);
  EXPECT_GT(exact->sigma_m, 0);
  EXPECT_LT(exact->sigma_m, rounded->sigma_m);
}

TEST(MarkerDepth, DoesNotTakeHolesAndOutliersForSkin) {
  cv::Mat depth = depth_image({0.0005, 0});
  for (int y = 16; y < 24; y += 2) depth.at<float>(y, 19) = 0;
  for (int y = 17; y < 24; y += 2) depth.at<float>(y, 22) = 0.95F;  // the background shows through
  depth.at<float>(20, 20) = 65.535F;
  depth.at<float>(21, 20) = std::numeric_limits<float>::quiet_NaN();
  const auto measured = measure_depth(depth, blob(), {});
  ASSERT_TRUE(measured);
  EXPECT_NEAR(measured->depth_m, 0.6, 2e-4);
}

TEST(MarkerDepth, SaysHowFarNoiseMovesIt) {
  const MarkerBlob marker = blob();
  DepthSettings settings;
  settings.correlation_px = 1;
  double sum_2 = 0, sigma_m = 0;
  constexpr int kImages = 200;
  for (unsigned seed = 0; seed < kImages; ++seed) {
    const auto depth = measure_depth(depth_image({0.0004, 0.0002}, 0.0009, seed), marker, settings);
    ASSERT_TRUE(depth);
    sum_2 += std::pow(depth->depth_m - 0.6, 2);
    sigma_m += depth->sigma_m / kImages;
  }
  EXPECT_NEAR(std::sqrt(sum_2 / kImages), sigma_m, 0.35 * sigma_m);
}

TEST(MarkerDepth, SeesThatSomethingNearerHidesAPart) {
  cv::Mat depth = depth_image({});
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 18; ++x) depth.at<float>(y, x) = 0.57F;
  const auto measured = measure_depth(depth, blob(), {});
  ASSERT_TRUE(measured);
  EXPECT_NEAR(measured->depth_m, 0.6, 5e-4);
  EXPECT_TRUE(measured->cut);
}

TEST(MarkerDepth, SaysNothingWhereNothingWasMeasured) {
  EXPECT_FALSE(measure_depth(cv::Mat::zeros(40, 40, CV_32F), blob(), {}));
  cv::Mat far(40, 40, CV_32F, cv::Scalar(65.535));
  EXPECT_FALSE(measure_depth(far, blob(), {}));
}

// Its depth is that of the part that shows, beside the marker's middle.
TEST(MarkerDetection, KnowsTheDepthOfAMarkerSeenInPartLessWellOnASlope) {
  const TrackerCamera camera = camera_at("camera", {0, -0.5, 0}, {0, 0, 0});
  TrackerSettings settings;
  settings.detector.colours = {{"blue", {{200, 260, 0.45, 1, 0.12, 1}}}};
  DrawnMarker cover;  // skin, 30 mm nearer, over the right third of the marker
  cover.position_m = {0.0075, -0.03, 0};
  cover.radius_m = 0;
  const auto sight_of = [&](const Eigen::Vector3d& normal) {
    DrawnMarker marker;
    marker.normal = normal.normalized();
    const auto sights = look(film(camera, {marker, cover}, 0), camera, {0, 0, 848, 480}, 0, settings);
    return sights.size() == 1 ? sights[0] : MarkerDetection{};
  };
  const MarkerDetection facing = sight_of({0, -1, 0}), tilted = sight_of({-1, -1, 0});
  ASSERT_TRUE(facing.partial && tilted.partial && facing.depth_m && tilted.depth_m);
  EXPECT_LT(facing.depth_sigma_m, 0.8e-3);
  EXPECT_GT(tilted.depth_sigma_m, 0.7e-3);
  EXPECT_LT(std::abs(*tilted.depth_m - 0.5), 2 * tilted.depth_sigma_m);
}

}  // namespace
}  // namespace soft_robot_lab
