// SPDX-License-Identifier: BSD-3-Clause
#include "perception/tracking/marker_detector.h"

#include <stdexcept>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "drawn_scene.h"

namespace soft_robot_lab {
namespace {

using namespace test;

DetectorSettings blue_and_red() {
  DetectorSettings settings;
  settings.colours = {{"blue", {{200, 260, 0.45, 1, 0.12, 1}}}, {"red", {{340, 20, 0.5, 1, 0.2, 1}}}};
  return settings;
}

const cv::Rect kEverywhere(0, 0, 10000, 10000);

std::vector<MarkerBlob> detect(const cv::Mat& rgb, const DetectorSettings& settings = blue_and_red()) {
  return detect_markers(rgb, kEverywhere, settings);
}

TEST(MarkerDetector, FindsCentresOfDrawnDiscsWithinATwentiethOfAPixel) {
  double worst_px = 0;
  for (double radius_px : {2.5, 3.1, 4.0, 6.3, 9.0})
    for (double x : {0.0, 0.13, 0.29, 0.5, 0.77})
      for (double y : {0.0, 0.21, 0.5, 0.9}) {
        cv::Mat image = plain_image(40, 40, kSkin);
        const Eigen::Vector2d centre(20 + x, 20 + y);
        draw_disc(image, centre, radius_px, kBlue);
        const auto blobs = detect(image);
        ASSERT_EQ(blobs.size(), 1u) << radius_px << " " << x << " " << y;
        worst_px = std::max(worst_px, (blobs[0].centre_px - centre).norm());
        EXPECT_NEAR(blobs[0].area_px, M_PI * radius_px * radius_px, 0.05 * M_PI * radius_px * radius_px + 1);
        EXPECT_FALSE(blobs[0].partial);
      }
  EXPECT_LT(worst_px, 0.05);
}

TEST(MarkerDetector, KeepsTheCentreWhereTheDarkBegins) {
  for (double gap_px : {0.0, 1.0, 2.5}) {
    cv::Mat image = plain_image(40, 40, kSkin);
    const Eigen::Vector2d centre(20.3, 19.8);
    const int edge = static_cast<int>(centre.x() + 4 + gap_px) + 1;
    image.colRange(edge, 40) = cv::Scalar(8, 8, 8);
    draw_disc(image, centre, 4, kBlue);
    const auto blobs = detect(image);
    ASSERT_EQ(blobs.size(), 1u);
    EXPECT_LT((blobs[0].centre_px - centre).norm(), 0.12) << gap_px;
  }
}

TEST(MarkerDetector, CountsAHighlightAsTheMarkers) {
  cv::Mat image = plain_image(40, 40, kSkin);
  const Eigen::Vector2d centre(20.4, 19.6);
  draw_disc(image, centre, 7, kBlue);
  draw_disc(image, centre + Eigen::Vector2d(2.5, 2), 1.5, {250, 250, 250});
  const auto blobs = detect(image);
  ASSERT_EQ(blobs.size(), 1u);
  EXPECT_LT((blobs[0].centre_px - centre).norm(), 0.1);
}

TEST(MarkerDetector, TellsColoursApartAndLetsHueGoRound) {
  cv::Mat image = plain_image(80, 40, kSkin);
  draw_disc(image, {20, 20}, 5, {200, 20, 45});  // a hue of 352 degrees
  draw_disc(image, {40, 20}, 5, kBlue);
  draw_disc(image, {60, 20}, 5, {200, 45, 20});  // 8 degrees
  const auto blobs = detect(image);
  ASSERT_EQ(blobs.size(), 3u);
  int reds = 0;
  for (const MarkerBlob& blob : blobs) {
    if (blob.colour == 1) ++reds;
    if (blob.colour == 0) {
      EXPECT_NEAR(blob.centre_px.x(), 40, 0.05);
    }
  }
  EXPECT_EQ(reds, 2);
}

TEST(MarkerDetector, CallsBlobsAtTheImagesEdgeAndTouchingOnesPartial) {
  cv::Mat image = plain_image(80, 40, kSkin);
  draw_disc(image, {1, 20}, 4, kBlue);
  draw_disc(image, {40, 20}, 5, kBlue);
  draw_disc(image, {50.5, 20}, 5, kRed);
  const auto blobs = detect(image);
  ASSERT_EQ(blobs.size(), 3u);
  for (const MarkerBlob& blob : blobs) EXPECT_TRUE(blob.partial) << blob.centre_px.transpose();
}

TEST(MarkerDetector, LeavesOutWhatIsTooSmallTooThinOrTooFaint) {
  cv::Mat image = plain_image(80, 40, kSkin);
  draw_disc(image, {10, 20}, 0.9, kBlue);
  cv::line(image, {25, 5}, {25, 35}, cv::Scalar(13, 38, 190), 2);
  cv::Mat dim = plain_image(40, 40, {14, 14, 14});
  draw_disc(dim, {20, 20}, 5, {3, 5, 33});
  EXPECT_TRUE(detect(image).empty());
  EXPECT_TRUE(detect(dim).empty());
}

TEST(MarkerDetector, LooksOnlyIntoTheRegion) {
  cv::Mat image = plain_image(80, 40, kSkin);
  draw_disc(image, {20, 20}, 5, kBlue);
  draw_disc(image, {60, 20}, 5, kBlue);
  const auto blobs = detect_markers(image, {45, 5, 100, 100}, blue_and_red());
  ASSERT_EQ(blobs.size(), 1u);
  EXPECT_LT((blobs[0].centre_px - Eigen::Vector2d(60, 20)).norm(), 0.05);
  EXPECT_TRUE(detect_markers(image, {100, 100, 5, 5}, blue_and_red()).empty());
}

TEST(MarkerDetector, ContrastFindsHolesInTheBrightAndMissesMarkersAtItsOutline) {
  DetectorSettings settings;
  settings.method = SegmentationMethod::contrast;
  settings.value_threshold = 0.76;
  cv::Mat image = plain_image(80, 60, kDark);
  image(cv::Rect(15, 5, 50, 50)) = cv::Scalar(200, 194, 184);
  draw_disc(image, {40.3, 30.7}, 5, kBlue);
  draw_disc(image, {65, 15}, 5, kBlue);  // half of it over the edge
  const auto blobs = detect(image, settings);
  ASSERT_EQ(blobs.size(), 1u);
  EXPECT_LT((blobs[0].centre_px - Eigen::Vector2d(40.3, 30.7)).norm(), 0.05);
  EXPECT_EQ(blobs[0].colour, -1);
}

TEST(MarkerDetector, ContrastKeepsAsManyOfTheLargestHolesAsThereAreMarkers) {
  DetectorSettings settings;
  settings.method = SegmentationMethod::contrast;
  settings.value_threshold = 0.5;
  cv::Mat image = plain_image(120, 60, kDark);
  image(cv::Rect(5, 5, 110, 50)) = cv::Scalar(200, 194, 184);
  const std::vector<double> radii_px = {2.5, 5, 3.5, 6, 3};
  for (std::size_t i = 0; i < radii_px.size(); ++i)
    draw_disc(image, {20.0 + 20.0 * double(i), 30}, radii_px[i], {8, 8, 8});
  EXPECT_EQ(detect(image, settings).size(), 5u);
  settings.marker_count = 3;
  const auto blobs = detect(image, settings);
  ASSERT_EQ(blobs.size(), 3u);
  const std::vector<double> largest_first_x_px = {80, 40, 60};
  for (std::size_t i = 0; i < blobs.size(); ++i) EXPECT_NEAR(blobs[i].centre_px.x(), largest_first_x_px[i], 0.05);
  settings.marker_count = 7;
  EXPECT_EQ(detect(image, settings).size(), 5u);
}

TEST(MarkerDetector, ContrastPassesOverWhatIsTooLargeBeforeItCounts) {
  DetectorSettings settings;
  settings.method = SegmentationMethod::contrast;
  settings.value_threshold = 0.5;
  settings.max_area_px = 200;
  settings.marker_count = 1;
  cv::Mat image = plain_image(120, 60, kDark);
  image(cv::Rect(5, 5, 110, 50)) = cv::Scalar(200, 194, 184);
  draw_disc(image, {30, 30}, 4, {8, 8, 8});
  draw_disc(image, {80, 30}, 20, {8, 8, 8});
  const auto blobs = detect(image, settings);
  ASSERT_EQ(blobs.size(), 1u);
  EXPECT_NEAR(blobs[0].centre_px.x(), 30, 0.05);
}

TEST(MarkerDetector, RefusesAnImageThatIsNotRgb8) {
  EXPECT_THROW(detect(cv::Mat::zeros(10, 10, CV_8U)), std::invalid_argument);
  EXPECT_THROW(detect(cv::Mat()), std::invalid_argument);
}

// A disc's centroid is not its middle's image: on a marker of 6 mm at 0.6 m that and drawing make less than 0.04 mm.
TEST(MarkerDetector, SeesATiltedDiscsMiddleWithinATwentyFifthOfAPixelOfItsCentroid) {
  const TrackerCamera camera = camera_at("left", {0, -0.6, 0}, {0, 0, 0});
  for (double angle : {0.0, 0.5, 1.0}) {
    const DrawnMarker marker{{0.05, 0, 0.03}, {std::sin(angle), -std::cos(angle), 0}};
    const auto blobs = detect(film(camera, {marker}, 0).colour);
    ASSERT_EQ(blobs.size(), 1u);
    const Eigen::Vector2d middle = camera.model.project(camera.world_from_camera.inverse() * marker.position_m);
    EXPECT_LT((blobs[0].centre_px - middle).norm(), 0.04) << angle;
  }
}

}  // namespace
}  // namespace soft_robot_lab
