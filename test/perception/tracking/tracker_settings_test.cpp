// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/perception/tracking/tracker_settings.h"

#include <filesystem>

#include <gtest/gtest.h>

#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

const std::string kBlue = "detector: {colours: {blue: [{hue_deg: [200, 260]}]}}\n";

std::string with_range(const std::string& range) { return "detector: {colours: {blue: [" + range + "]}}\n"; }

TEST(TrackerSettings, ReadsWhatIsGivenAndKeepsTheRest) {
  const TrackerSettings settings = parse_tracker(
      "detector: {colours: {red: [{hue_deg: [340, 20]}, {hue_deg: [0, 30], saturation: [0.6, 1]}]}, min_area_px: 9}\n"
      "motion: {lost_after_s: 3}\nmarker_colours: {tip: red}\n",
      "here");
  ASSERT_EQ(settings.detector.colours.size(), 1u);
  ASSERT_EQ(settings.detector.colours[0].ranges.size(), 2u);
  EXPECT_EQ(settings.detector.colours[0].ranges[0].hue_min_deg, 340);
  EXPECT_EQ(settings.detector.colours[0].ranges[1].saturation_min, 0.6);
  EXPECT_EQ(settings.detector.min_area_px, 9);
  EXPECT_EQ(settings.motion.lost_after_s, 3);
  EXPECT_EQ(settings.motion.gate, MotionSettings().gate);
  EXPECT_EQ(settings.marker_colours.at("tip"), "red");
}

struct Refused {
  std::string text;
  std::string words;  // that the message has
};

TEST(TrackerSettings, RefusesWhatCannotBeByNameAndRange) {
  const std::vector<Refused> table = {
      {"{}", "detector"},
      {"detector: {}", "colours"},
      {"detector: {colours: {blue: []}}", "blue"},
      {"detector: {method: magic}", "method"},
      {"detector: {method: contrast, value_threshold: 1}", "value_threshold"},
      {with_range("{hue_deg: [200, 400]}"), "[0, 360]"},
      {with_range("{hue_deg: [-10, 20]}"), "[0, 360]"},
      {with_range("{hue_deg: [200]}"), "hue_deg"},
      {with_range("{hue_deg: [200, 200]}"), "hue_deg"},
      {with_range("{hue_deg: [200, 260], saturation: [0.9, 0.2]}"), "saturation"},
      {with_range("{hue_deg: [200, 260], saturation: [0, 255]}"), "[0, 1]"},
      {with_range("{hue_deg: [200, 260], value: [0.5, 0.5]}"), "value"},
      {with_range("{hue_deg: [200, 260], value: [.nan, 0.5]}"), "value"},
      {with_range("{}"), "every colour"},
      {with_range("{hue_deg: [200, 260], hues: 3}"), "hues"},
      {"detector: {method: contrast, marker_count: 0}", "marker_count"},
      {"detector: {method: contrast, marker_count: 2.5}", "marker_count"},
      {"detector: {marker_count: 5, colours: {blue: [{hue_deg: [200, 260]}]}}", "only with the method contrast"},
      {"detector: {method: contrast, min_area_px: 0}", "min_area_px"},
      {"detector: {method: contrast, min_area_px: 50, max_area_px: 40}", "max_area_px"},
      {"detector: {method: contrast, min_roundness: 1}", "min_roundness"},
      {"detector: {method: contrast, min_contrast: 0}", "min_contrast"},
      {"detector: {method: contrast, centroid_floor_px: 0}", "centroid_floor_px"},
      {"detector: {method: contrast, edge_noise_px: -1}", "edge_noise_px"},
      {kBlue + "depth: {noise_per_m: 0}", "noise_per_m"},
      {kBlue + "depth: {correlation_px: 0}", "correlation_px"},
      {kBlue + "depth: {quantisation_m: -0.001}", "quantisation_m"},
      {kBlue + "depth: {min_m: 0}", "min_m"},
      {kBlue + "depth: {min_m: 2, max_m: 1}", "max_m"},
      {kBlue + "motion: {acceleration_m_s2: 0}", "acceleration_m_s2"},
      {kBlue + "motion: {start_sigma_m: 0}", "start_sigma_m"},
      {kBlue + "motion: {gate: 0}", "gate"},
      {kBlue + "motion: {seen_sigma_m: 0}", "seen_sigma_m"},
      {kBlue + "motion: {velocity_decay_s: 0}", "velocity_decay_s"},
      {kBlue + "motion: {hidden_growth_m_s: 0}", "hidden_growth_m_s"},
      {kBlue + "motion: {neighbour_ratio: 0}", "neighbour_ratio"},
      {kBlue + "motion: {lost_after_s: 0}", "lost_after_s"},
      {kBlue + "motion: {max_stretch: 0}", "max_stretch"},
      {kBlue + "marker_radius_m: 0", "marker_radius_m"},
      {kBlue + "region_margin_m: -1", "region_margin_m"},
      {kBlue + "readout_s: 1", "readout_s"},
      {kBlue + "camera_timeout_s: 0", "camera_timeout_s"},
      {kBlue + "marker_colours: {tip: green}", "tip"},
      {kBlue + "markers: 3", "markers"},
  };
  for (const Refused& refused : table) {
    try {
      parse_tracker(refused.text, "here");
      ADD_FAILURE() << "taken: " << refused.text;
    } catch (const SettingsError& error) {
      EXPECT_NE(std::string(error.what()).find(refused.words), std::string::npos) << error.what();
    }
  }
}

TEST(TrackerSettings, ReadsHowManyHolesToKeep) {
  EXPECT_EQ(parse_tracker("detector: {method: contrast, marker_count: 5}", "here").detector.marker_count, 5);
  EXPECT_EQ(parse_tracker("detector: {method: contrast}", "here").detector.marker_count, 0);
}

TEST(TrackerSettings, LoadsEveryTrackerFile) {
  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(SOFT_ROBOT_LAB_SOURCE "/config/robots")) {
    if (entry.path().filename().string().find("tracker") != 0) continue;
    EXPECT_NO_THROW(load_tracker(entry.path().string())) << entry.path();
    ++files;
  }
  EXPECT_GE(files, 8);
}

}  // namespace
}  // namespace soft_robot_lab
