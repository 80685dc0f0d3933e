// SPDX-License-Identifier: BSD-3-Clause
#include "perception/tracking/colour_tuning.h"

#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "soft_robot_lab/settings/yaml_node.h"
#include "drawn_scene.h"

namespace soft_robot_lab {
namespace {

cv::Mat two_stickers() {
  cv::Mat image = test::plain_image(120, 80, test::kSkin);
  test::draw_disc(image, {30, 40}, 6, test::kBlue);
  test::draw_disc(image, {90, 40}, 6, test::kRed);
  return image;
}

int lit(const cv::Mat& view, const cv::Rect& area) {
  cv::Mat channel;
  cv::extractChannel(view(area), channel, 0);
  return cv::countNonZero(channel == 255);
}

TEST(ColourTuning, ARangeOfASampleTakesInItsStickerAndNothingElse) {
  const cv::Mat image = two_stickers();
  const HsvRange blue = range_of(sample(image, {30, 40}, 3));
  EXPECT_LT(blue.hue_min_deg, 231);
  EXPECT_GT(blue.hue_max_deg, 231);
  EXPECT_LT(blue.hue_max_deg - blue.hue_min_deg, 40);
  DetectorSettings detector;
  detector.colours = {{"blue", {blue}}, {"red", {range_of(sample(image, {90, 40}, 3))}}};
  for (const std::size_t colour : {0u, 1u}) {
    const cv::Mat view = tuning_view(image, detector, colour);
    ASSERT_EQ(view.size(), cv::Size(240, 80));
    const int left = lit(view, {120, 0, 60, 80}), right = lit(view, {180, 0, 60, 80});
    EXPECT_NEAR(colour == 0 ? left : right, M_PI * 36, 20);  // but for the mixed edge
    EXPECT_EQ(colour == 0 ? right : left, 0);
  }
}

TEST(ColourTuning, ARangeOfRedGoesThroughZero) {
  const cv::Mat image = two_stickers();
  const HsvRange red = range_of(sample(image, {90, 40}, 3));
  EXPECT_GT(red.hue_min_deg, 330);
  EXPECT_LT(red.hue_max_deg, 30);
}

TEST(ColourTuning, OneOddPixelInTwentyDoesNotWidenARange) {
  std::vector<cv::Vec3b> pixels(100, cv::Vec3b(13, 38, 190));
  const HsvRange range = range_of(pixels);
  pixels[7] = {20, 200, 30};
  EXPECT_EQ(range_of(pixels).hue_min_deg, range.hue_min_deg);
}

TEST(ColourTuning, RefusesGreyAndNothing) {
  EXPECT_THROW(range_of({}), std::invalid_argument);
  EXPECT_THROW(range_of(sample(two_stickers(), {5, 5}, 3)), std::invalid_argument);
  EXPECT_THROW(range_of(sample(two_stickers(), {-50, 5}, 3)), std::invalid_argument);
}

constexpr char settings_text[] = R"(# Stickers of the lab.
detector:
  method: colour
  colours:   # tuned in May
    blue: [{hue_deg: [200, 260], saturation: [0.45, 1], value: [0.12, 1]}]
    # and the tip's
    red: [{hue_deg: [340, 20], saturation: [0.5, 1], value: [0.2, 1]}]
  min_area_px: 7   # at 0.6 m
depth: {min_m: 0.2}
marker_radius_m: 0.0035
)";

TEST(ColourTuning, WritesColoursAndKeepsEveryOtherLine) {
  HsvRange green;
  green.hue_min_deg = 90, green.hue_max_deg = 150, green.saturation_min = 0.3;
  const std::string text = with_colours(settings_text, {{"green", {green, {10, 20, 0.5, 1, 0.25, 0.75}}}});
  EXPECT_EQ(text, R"(# Stickers of the lab.
detector:
  method: colour
  colours:
    green:
      - {hue_deg: [90, 150], saturation: [0.3, 1], value: [0, 1]}
      - {hue_deg: [10, 20], saturation: [0.5, 1], value: [0.25, 0.75]}
  min_area_px: 7   # at 0.6 m
depth: {min_m: 0.2}
marker_radius_m: 0.0035
)");
  const TrackerSettings read = parse_tracker(text, "test");
  ASSERT_EQ(read.detector.colours.size(), 1u);
  EXPECT_EQ(read.detector.colours[0].ranges[1].value_max, 0.75);
  EXPECT_EQ(read.detector.min_area_px, 7);
  EXPECT_EQ(with_colours(text, read.detector.colours), text);
}

TEST(ColourTuning, AddsColoursWhereThereWereNone) {
  const HsvRange blue{200, 260, 0.5, 1, 0.2, 1};
  const std::string text = with_colours("detector:\n  method: contrast\n", {{"blue", {blue}}});
  EXPECT_EQ(parse_tracker(text, "test").detector.colours.size(), 1u);
}

TEST(ColourTuning, RefusesWhatItCannotReplaceOrRead) {
  const HsvRange blue{200, 260, 0.5, 1, 0.2, 1};
  EXPECT_THROW(with_colours("detector: {colours: {blue: [{hue_deg: [200, 260]}]}}\n", {{"blue", {blue}}}),
               std::invalid_argument);
  EXPECT_THROW(with_colours("marker_radius_m: 0.003\n", {{"blue", {blue}}}), std::invalid_argument);
  HsvRange absurd = blue;
  absurd.value_min = 1;
  EXPECT_THROW(with_colours(settings_text, {{"blue", {absurd}}}), SettingsError);
  EXPECT_THROW(with_colours(settings_text, {}), SettingsError);
}

}  // namespace
}  // namespace soft_robot_lab
