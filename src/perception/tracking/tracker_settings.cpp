// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/perception/tracking/tracker_settings.h"

#include <algorithm>
#include <set>

#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

constexpr double kFullCircleDeg = 360;

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
  detector.value_threshold = node.number_or("value_threshold", detector.value_threshold, {0, 1, true, true});
  if (node.has("marker_count") && detector.method != SegmentationMethod::contrast)
    node.fail("marker_count: counts holes; allowed: only with the method contrast");
  if (node.has("marker_count")) detector.marker_count = node.integer("marker_count", 1, 10000);
  detector.min_area_px = node.number_or("min_area_px", detector.min_area_px, {1, 1e6});
  detector.max_area_px = node.number_or("max_area_px", detector.max_area_px, {detector.min_area_px, 1e7, true});
  detector.min_roundness = node.number_or("min_roundness", detector.min_roundness, {0, 1, false, true});
  detector.min_contrast = node.number_or("min_contrast", detector.min_contrast, {0, 1, true, true});
  detector.centroid_floor_px = node.number_or("centroid_floor_px", detector.centroid_floor_px, {0.001, 5});
  detector.edge_noise_px = node.number_or("edge_noise_px", detector.edge_noise_px, {0, 5});
  return detector;
}

MotionSettings read_motion(const YamlNode& node) {
  MotionSettings motion;
  motion.acceleration_m_s2 = node.number_or("acceleration_m_s2", motion.acceleration_m_s2, {1e-3, 1e3});
  motion.start_sigma_m = node.number_or("start_sigma_m", motion.start_sigma_m, {1e-4, 1});
  motion.gate = node.number_or("gate", motion.gate, {1, 1000});
  motion.seen_sigma_m = node.number_or("seen_sigma_m", motion.seen_sigma_m, {1e-5, 0.1});
  motion.velocity_decay_s = node.number_or("velocity_decay_s", motion.velocity_decay_s, {1e-3, 10});
  motion.hidden_growth_m_s = node.number_or("hidden_growth_m_s", motion.hidden_growth_m_s, {1e-5, 1});
  motion.neighbour_ratio = node.number_or("neighbour_ratio", motion.neighbour_ratio, {0.01, 10});
  motion.lost_after_s = node.number_or("lost_after_s", motion.lost_after_s, {0.01, 1000});
  motion.max_stretch = node.number_or("max_stretch", motion.max_stretch, {0.01, 10});
  return motion;
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
  settings.depth = read_depth_settings(node, settings.depth);
  if (const auto motion = node.optional_child("motion")) settings.motion = read_motion(*motion);
  settings.marker_radius_m = node.number_or("marker_radius_m", settings.marker_radius_m, {1e-4, 0.1});
  settings.region_margin_m = node.number_or("region_margin_m", settings.region_margin_m, {0, 1});
  settings.readout_s = node.number_or("readout_s", settings.readout_s, {0, 0.1});
  settings.camera_timeout_s = node.number_or("camera_timeout_s", settings.camera_timeout_s, {0.01, 1000});
  if (const auto colours = node.optional_child("marker_colours"))
    settings.marker_colours = read_marker_colours(*colours, settings.detector);
  node.require_all_read();
  return settings;
}

}  // namespace

DepthSettings read_depth_settings(const YamlNode& parent, DepthSettings depth) {
  const auto node = parent.optional_child("depth");
  if (!node) return depth;
  depth.noise_per_m = node->number_or("noise_per_m", depth.noise_per_m, {1e-6, 1});
  depth.correlation_px = node->number_or("correlation_px", depth.correlation_px, {1, 50});
  depth.quantisation_m = node->number_or("quantisation_m", depth.quantisation_m, {0, 0.1});
  depth.min_m = node->number_or("min_m", depth.min_m, AllowedRange::positive());
  depth.max_m = node->number_or("max_m", depth.max_m, {depth.min_m, 65.535, true});
  return depth;
}

TrackerSettings load_tracker(const std::string& path) { return read_tracker(YamlNode::load_file(path)); }

TrackerSettings parse_tracker(const std::string& text, const std::string& source_name) {
  return read_tracker(YamlNode::parse(text, source_name));
}

}  // namespace soft_robot_lab
