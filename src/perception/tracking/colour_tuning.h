// SPDX-License-Identifier: BSD-3-Clause
// Finding the ranges of a marker's colour by eye: what a person clicks on, what a range takes in, and the file it goes
// to.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include "soft_robot_lab/perception/tracking/tracker_settings.h"

namespace soft_robot_lab {

// The pixels of an rgb8 image within `radius_px` of a place, for range_of().
std::vector<cv::Vec3b> sample(const cv::Mat& rgb, const cv::Point& place, int radius_px);

struct TuningMargins {
  double hue_deg = 12;
  double saturation = 0.15, value = 0.15;
};

// The range that holds all but the outermost twentieth of the samples, with margins; saturation and value are open
// upwards. Throws std::invalid_argument: no samples, or grey ones, which have no hue.
HsvRange range_of(const std::vector<cv::Vec3b>& rgb, const TuningMargins& margins = {});

// The image with what is in none of the detector's ranges as dark grey and the markers it finds circled; beside it the
// mask of `colour` (its place in the detector's list). rgb8.
cv::Mat tuning_view(const cv::Mat& rgb, const DetectorSettings& detector, std::size_t colour);

// A tracker's settings with other colours; every other line stays as it is. Throws std::invalid_argument where the
// detector's keys do not stand on lines of their own, and SettingsError where the outcome cannot be read.
std::string with_colours(const std::string& settings, const std::vector<MarkerColour>& colours);

}  // namespace soft_robot_lab
