// SPDX-License-Identifier: BSD-3-Clause
// What a tracker's YAML file says: how markers look, how well cameras measure, and what is believed of motion.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

// A box of colours. Hue goes round: a minimum above the maximum crosses red at 0 degrees.
struct HsvRange {
  double hue_min_deg = 0, hue_max_deg = 360;      // [0, 360]
  double saturation_min = 0, saturation_max = 1;  // [0, 1]
  double value_min = 0, value_max = 1;            // [0, 1]
};

struct MarkerColour {
  std::string name;
  std::vector<HsvRange> ranges;
};

enum class SegmentationMethod {
  colour,   // pixels within a colour's ranges
  contrast  // holes in the bright robot: a value threshold, and what filling holes adds to it
};

struct DetectorSettings {
  SegmentationMethod method = SegmentationMethod::colour;
  std::vector<MarkerColour> colours;  // for `colour`: at least one
  double value_threshold = 0.35;      // for `contrast`: the robot is brighter, its markers are not; (0, 1)
  int marker_count = 0;  // for `contrast`: of the holes within the limits below so many of the largest are kept; 0: all
  double min_area_px = 6;
  double max_area_px = 4000;
  double min_roundness = 0.2;       // minor over major axis; a disc seen at 78 degrees
  double min_contrast = 0.12;       // of the marker against what surrounds it; full scale is 1
  double centroid_floor_px = 0.03;  // standard deviation of the centroid of a large, clear blob
  double edge_noise_px = 0.12;  // of a pixel of the outline at full contrast; the centroid's falls with their number
};

// Standard deviation of one depth: noise_per_m * depth^2, and quantisation beside it.
struct DepthSettings {
  double noise_per_m = 0.0025;     // 0.9 mm at 0.6 m
  double correlation_px = 3;       // errors of pixels nearer than this are alike
  double quantisation_m = 0.001;   // 0: depths are not rounded
  double min_m = 0.15, max_m = 3;  // others count as not measured
};

struct MotionSettings {
  double acceleration_m_s2 = 2;      // standard deviation of what nobody foresaw
  double start_sigma_m = 0.008;      // of rest positions, or simulated ones, before a marker was ever seen
  double gate = 25;                  // squared Mahalanobis distance beyond which a sight is not this marker's
  double seen_sigma_m = 0.002;       // an estimate less certain than this is not called seen
  double velocity_decay_s = 0.15;    // of a hidden marker without neighbours
  double hidden_growth_m_s = 0.004;  // growth of a hidden marker's standard deviation with time,
  double neighbour_ratio = 0.5;      // and with what its neighbours moved meanwhile
  double lost_after_s = 2;           // without sight
  double max_stretch = 0.6;          // of the distance between neighbours; a swap shows as more
};

struct TrackerSettings {
  DetectorSettings detector;
  DepthSettings depth;
  MotionSettings motion;
  double marker_radius_m = 0.003;
  double region_margin_m = 0.02;  // searched around where markers are expected
  double readout_s = 0;           // from the first row's exposure to the last one's: rolling shutter
  double camera_timeout_s = 0.5;  // a camera silent for longer is reported
  std::map<std::string, std::string> marker_colours;  // of named markers; the others may have any
};

// A number of the settings: its part and key in the file, and what it may be. Files and a running tracker take the
// same.
struct TrackerNumber {
  std::string part;  // `detector`, `depth` or `motion`; empty for what stands beside them
  std::string key;
  double* value;  // in the settings that were asked
  AllowedRange range;
};
// All of them; a range may depend on another number, as it is now.
std::vector<TrackerNumber> numbers_of(TrackerSettings& settings);

// Throw SettingsError: file, line, key, value and allowed range.
TrackerSettings load_tracker(const std::string& path);
TrackerSettings parse_tracker(const std::string& text, const std::string& source_name);
DepthSettings read_depth_settings(const YamlNode& parent, DepthSettings otherwise);  // its `depth`, if it has one

}  // namespace soft_robot_lab
