// SPDX-License-Identifier: BSD-3-Clause
#include "explain_unseen.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>

#include <opencv2/imgproc.hpp>

#include "marker_detection.h"
#include "settings/quantile.h"

namespace soft_robot_lab {
namespace {

cv::Rect whole(const cv::Mat& image) { return {0, 0, image.cols, image.rows}; }

std::string nothing_like_a_marker(const RgbdFrame& frame, const TrackerSettings& settings) {
  cv::Mat exchanged;
  cv::cvtColor(frame.colour, exchanged, cv::COLOR_RGB2BGR);
  const std::size_t found = detect_markers(exchanged, whole(exchanged), settings.detector).size();
  if (found == 0) return "nothing in its image looks like a marker";
  return "nothing in its image looks like a marker, but " + std::to_string(found) +
         " with red and blue exchanged: its encoding is not what the image says";
}

// Of what was measured within two pixels; whatever the tracker thinks of it.
std::optional<double> depth_beside_m(const cv::Mat& depth_m, const Eigen::Vector2d& pixel) {
  const cv::Rect around(static_cast<int>(pixel.x()) - 2, static_cast<int>(pixel.y()) - 2, 5, 5);
  std::vector<double> depths_m;
  const cv::Mat part = depth_m(around & whole(depth_m));
  for (int row = 0; row < part.rows; ++row)
    for (int column = 0; column < part.cols; ++column)
      if (const double depth = part.at<float>(row, column); depth > 0) depths_m.push_back(depth);
  if (depths_m.empty()) return std::nullopt;
  return median(std::move(depths_m));
}

double expected_depth_m(const TrackerCamera& camera, const std::vector<TrackedMarker>& markers) {
  std::vector<double> depths_m;
  for (const TrackedMarker& marker : markers)
    depths_m.push_back((camera.world_from_camera.inverse() * marker.rest_position_m).z());
  return median(std::move(depths_m));
}

// Empty where no power of ten lies between what is measured and what is expected.
std::string another_unit(double measured_m, double expected_m) {
  constexpr double close = 0.15;  // in powers of ten: a factor of 1.4
  if (!(expected_m > 0)) return "";
  const double power = std::log10(measured_m / expected_m);
  if (std::abs(power) < 0.5 || std::abs(power - std::round(power)) > close) return "";
  std::ostringstream text;
  text << "; markers are expected at " << expected_m << " m, so depth is in another unit, by a factor of "
       << std::pow(10.0, std::round(power));
  return text.str();
}

double nearest_to_a_marker_m(const std::vector<MarkerDetection>& sights, const std::vector<TrackedMarker>& markers) {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const MarkerDetection& sight : sights)
    for (const TrackedMarker& marker : markers)
      if (sight.depth_m) nearest_m = std::min(nearest_m, (sight.point_m() - marker.rest_position_m).norm());
  return nearest_m;
}

}  // namespace

std::string explain_unseen(const RgbdFrame& frame, const TrackerCamera& camera,
                           const std::vector<TrackedMarker>& markers, const TrackerSettings& settings) {
  const std::vector<MarkerDetection> sights = look(frame, camera, whole(frame.colour), frame.stamp_s, settings);
  if (sights.empty()) return nothing_like_a_marker(frame, settings);
  std::vector<double> depths_m;
  for (const MarkerDetection& sight : sights)
    if (const auto depth_m = depth_beside_m(frame.depth_m, sight.pixel)) depths_m.push_back(*depth_m);
  std::ostringstream text;
  text.precision(3);
  text << sights.size() << (sights.size() == 1 ? " thing looks" : " things look") << " like a marker, ";
  if (depths_m.empty()) {
    text << (cv::countNonZero(frame.depth_m) == 0 ? "and its depth image is empty" : "but none of them has a depth");
    return text.str();
  }
  const double measured_m = median(std::move(depths_m));
  const bool usable = std::any_of(sights.begin(), sights.end(), [](const auto& sight) { return !!sight.depth_m; });
  text << "at " << measured_m << " m";
  if (!usable) text << ", where depth counts from " << settings.depth.min_m << " to " << settings.depth.max_m << " m";
  const std::string unit = another_unit(measured_m, expected_depth_m(camera, markers));
  text << unit;
  if (usable && unit.empty())
    text << ", the nearest " << 1e3 * nearest_to_a_marker_m(sights, markers)
         << " mm from where a marker rests: does the camera stand where its pose says?";
  return text.str();
}

}  // namespace soft_robot_lab
