// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/perception/tracking/tracker_settings.h"

#include <algorithm>
#include <set>

#include "settings/limits.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

constexpr double kFullCircleDeg = 360;
constexpr double kFarthest_m = limits::kDepth_m;  // of 16 bits in mm

// Two numbers of a list "KEY: [min, max]".
void read_pair(const YamlNode& node, const std::string& key, double max_allowed, double& min, double& max) {
  if (!node.has(key)) return;
  const std::vector<YamlNode> ends = node.sequence(key);
  if (ends.size() != 2) node.fail(key + " has " + std::to_string(ends.size()) + " numbers; allowed: [min, max]");
  min = ends[0].as_number({0, max_allowed});
  max = ends[1].as_number({0, max_allowed});
}

HsvRange read_range(const YamlNode& node) {
  HsvRange range;
  read_pair(node, "hue_deg", kFullCircleDeg, range.hue_min_deg, range.hue_max_deg);
  read_pair(node, "saturation", 1, range.saturation_min, range.saturation_max);
  read_pair(node, "value", 1, range.value_min, range.value_max);
  if (range.hue_min_deg == range.hue_max_deg) node.fail("hue_deg: no width; allowed: two unlike angles in [0, 360]");
  if (range.saturation_min >= range.saturation_max) node.fail("saturation: min is not below max; allowed: in [0, 1]");
  if (range.value_min >= range.value_max) node.fail("value: min is not below max; allowed: in [0, 1]");
  const double hue_width_deg = range.hue_max_deg - range.hue_min_deg;
  if (hue_width_deg >= kFullCircleDeg && range.saturation_min == 0 && range.value_min == 0 && range.value_max == 1)
    node.fail("holds every grey and every colour; allowed: a range that leaves the background out");
  return range;
}

std::vector<MarkerColour> read_colours(const YamlNode& node) {
  std::vector<MarkerColour> colours;
  for (const std::string& name : node.keys()) {
    MarkerColour colour{name, {}};
    for (const YamlNode& range : node.sequence(name)) colour.ranges.push_back(read_range(range));
    if (colour.ranges.empty()) node.fail(name + ": no range; allowed: at least one");
    colours.push_back(colour);
  }
  return colours;
}

DetectorSettings read_detector(const YamlNode& node) {
  DetectorSettings detector;
  if (node.choice_or("method", "colour", {"colour", "contrast"}) == "contrast")
    detector.method = SegmentationMethod::contrast;
  if (const auto colours = node.optional_child("colours")) detector.colours = read_colours(*colours);
  if (detector.method == SegmentationMethod::colour && detector.colours.empty())
    node.fail("colours: none; allowed: at least one for the method colour");
  if (node.has("marker_count") && detector.method != SegmentationMethod::contrast)
    node.fail("marker_count: counts holes; allowed: only with the method contrast");
  if (node.has("marker_count")) detector.marker_count = node.integer("marker_count", 1, 10000);
  return detector;
}

// One after the other, as a later range may depend on an earlier number.
void read_numbers(const YamlNode& node, const std::string& part, TrackerSettings& settings) {
  for (std::size_t i = 0; i < numbers_of(settings).size(); ++i) {
    const TrackerNumber number = numbers_of(settings)[i];
    if (number.part == part) *number.value = node.number_or(number.key, *number.value, number.range);
  }
}

std::map<std::string, std::string> read_marker_colours(const YamlNode& node, const DetectorSettings& detector) {
  std::vector<std::string> known;
  for (const MarkerColour& colour : detector.colours) known.push_back(colour.name);
  std::map<std::string, std::string> colours;
  for (const std::string& marker : node.keys()) colours[marker] = node.choice(marker, known);
  return colours;
}

TrackerSettings read_tracker(const YamlNode& node) {
  TrackerSettings settings;
  settings.detector = read_detector(node.child("detector"));
  read_numbers(node, "", settings);
  for (const char* part : {"detector", "depth", "motion"})
    if (const auto numbers = node.optional_child(part)) read_numbers(*numbers, part, settings);
  if (const auto colours = node.optional_child("marker_colours"))
    settings.marker_colours = read_marker_colours(*colours, settings.detector);
  node.require_all_read();
  return settings;
}

}  // namespace

std::vector<TrackerNumber> numbers_of(TrackerSettings& settings) {
  DetectorSettings& detector = settings.detector;
  DepthSettings& depth = settings.depth;
  MotionSettings& motion = settings.motion;
  return {{"detector", "value_threshold", &detector.value_threshold, {0, 1, true, true}},
          {"detector", "min_area_px", &detector.min_area_px, {1, 1e6}},
          {"detector", "max_area_px", &detector.max_area_px, {detector.min_area_px, 1e7, true}},
          {"detector", "min_roundness", &detector.min_roundness, {0, 1, false, true}},
          {"detector", "min_contrast", &detector.min_contrast, {0, 1, true, true}},
          {"detector", "centroid_floor_px", &detector.centroid_floor_px, {0.001, 5}},
          {"detector", "edge_noise_px", &detector.edge_noise_px, {0, 5}},
          {"depth", "noise_per_m", &depth.noise_per_m, {1e-6, 1}},
          {"depth", "correlation_px", &depth.correlation_px, {1, 50}},
          {"depth", "quantisation_m", &depth.quantisation_m, {0, 0.1}},
          {"depth", "min_m", &depth.min_m, {0, kFarthest_m, true, true}},
          {"depth", "max_m", &depth.max_m, {depth.min_m, kFarthest_m, true}},
          {"motion", "acceleration_m_s2", &motion.acceleration_m_s2, {1e-3, 1e3}},
          {"motion", "start_sigma_m", &motion.start_sigma_m, {1e-4, 1}},
          {"motion", "gate", &motion.gate, {1, 1000}},
          {"motion", "seen_sigma_m", &motion.seen_sigma_m, {1e-5, 0.1}},
          {"motion", "velocity_decay_s", &motion.velocity_decay_s, {1e-3, 10}},
          {"motion", "hidden_growth_m_s", &motion.hidden_growth_m_s, {1e-5, 1}},
          {"motion", "neighbour_ratio", &motion.neighbour_ratio, {0.01, 10}},
          {"motion", "lost_after_s", &motion.lost_after_s, {0.01, 1000}},
          {"motion", "max_stretch", &motion.max_stretch, {0.01, 10}},
          {"", "marker_radius_m", &settings.marker_radius_m, {1e-4, 0.1}},
          {"", "region_margin_m", &settings.region_margin_m, {0, 1}},
          {"", "readout_s", &settings.readout_s, {0, 0.1}},
          {"", "camera_timeout_s", &settings.camera_timeout_s, {0.01, 1000}}};
}

DepthSettings read_depth_settings(const YamlNode& parent, DepthSettings otherwise) {
  TrackerSettings settings;
  settings.depth = otherwise;
  if (const auto node = parent.optional_child("depth")) read_numbers(*node, "depth", settings);
  return settings.depth;
}

TrackerSettings load_tracker(const std::string& path) { return read_tracker(YamlNode::load_file(path)); }

TrackerSettings parse_tracker(const std::string& text, const std::string& source_name) {
  return read_tracker(YamlNode::parse(text, source_name));
}

}  // namespace soft_robot_lab
