// SPDX-License-Identifier: BSD-3-Clause
#include "colour_tuning.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "settings/quantile.h"
#include "marker_detector.h"
#include "segmentation.h"

namespace soft_robot_lab {
namespace {

constexpr double kGrey = 0.1;  // saturation below which a hue says nothing
constexpr double kTail = 0.05;

// From -180 to 180 degrees.
double turn_deg(double from_deg, double to_deg) { return std::remainder(to_deg - from_deg, 360); }

double on_circle_deg(double angle_deg) {
  const double positive = std::fmod(angle_deg, 360);
  return positive < 0 ? positive + 360 : positive;
}

}  // namespace

std::vector<cv::Vec3b> sample(const cv::Mat& rgb, const cv::Point& place, int radius_px) {
  std::vector<cv::Vec3b> pixels;
  for (int y = std::max(0, place.y - radius_px); y <= std::min(rgb.rows - 1, place.y + radius_px); ++y)
    for (int x = std::max(0, place.x - radius_px); x <= std::min(rgb.cols - 1, place.x + radius_px); ++x)
      if (std::hypot(x - place.x, y - place.y) <= radius_px) pixels.push_back(rgb.at<cv::Vec3b>(y, x));
  return pixels;
}

HsvRange range_of(const std::vector<cv::Vec3b>& rgb, const TuningMargins& margins) {
  if (rgb.empty()) throw std::invalid_argument("the sample has no pixels; allowed: at least one within the image");
  cv::Mat hsv;
  cv::cvtColor(cv::Mat(rgb), hsv, cv::COLOR_RGB2HSV);
  std::vector<double> hues_deg, saturations, values;
  double east = 0, north = 0;
  for (const cv::Vec3b& pixel : cv::Mat_<cv::Vec3b>(hsv)) {
    const double saturation = pixel[1] / 255.0;
    if (saturation < kGrey) continue;
    hues_deg.push_back(2.0 * pixel[0]);
    saturations.push_back(saturation);
    values.push_back(pixel[2] / 255.0);
    east += saturation * std::cos(hues_deg.back() * M_PI / 180);
    north += saturation * std::sin(hues_deg.back() * M_PI / 180);
  }
  if (2 * hues_deg.size() < rgb.size())
    throw std::invalid_argument("the sample is grey (saturation below 0.1) and has no hue; allowed: coloured pixels");
  const double middle_deg = std::atan2(north, east) * 180 / M_PI;
  for (double& hue_deg : hues_deg) hue_deg = turn_deg(middle_deg, hue_deg);
  const double low_deg = quantile(hues_deg, kTail) - margins.hue_deg;
  const double high_deg = quantile(hues_deg, 1 - kTail) + margins.hue_deg;
  HsvRange range;
  if (high_deg - low_deg < 360) {
    range.hue_min_deg = std::round(on_circle_deg(middle_deg + low_deg));
    range.hue_max_deg = std::round(on_circle_deg(middle_deg + high_deg));
  }
  const auto floor = [](double value, double margin) { return std::clamp(value - margin, 0.0, 0.95); };
  range.saturation_min = 0.01 * std::round(100 * floor(quantile(saturations, kTail), margins.saturation));
  range.value_min = 0.01 * std::round(100 * floor(quantile(values, kTail), margins.value));
  return range;
}

cv::Mat tuning_view(const cv::Mat& rgb, const DetectorSettings& detector, std::size_t colour) {
  cv::Mat hsv, grey, view;
  cv::cvtColor(rgb, hsv, cv::COLOR_RGB2HSV);
  cv::cvtColor(rgb, grey, cv::COLOR_RGB2GRAY);
  cv::cvtColor(0.5 * grey, view, cv::COLOR_GRAY2RGB);
  for (const MarkerColour& each : detector.colours) rgb.copyTo(view, colour_mask(hsv, each));
  DetectorSettings by_colour = detector;
  by_colour.method = SegmentationMethod::colour;
  by_colour.marker_count = 0;
  for (const MarkerBlob& blob : detect_markers(rgb, {{0, 0}, rgb.size()}, by_colour)) {
    const cv::Point centre(static_cast<int>(std::lround(blob.centre_px.x())),
                           static_cast<int>(std::lround(blob.centre_px.y())));
    const int radius_px = static_cast<int>(std::sqrt(blob.area_px / M_PI)) + 4;
    cv::circle(view, centre, radius_px, cv::Scalar(40, 220, 60), 1, cv::LINE_AA);
  }
  cv::Mat mask, both;
  cv::cvtColor(colour_mask(hsv, detector.colours.at(colour)), mask, cv::COLOR_GRAY2RGB);
  cv::hconcat(view, mask, both);
  return both;
}

}  // namespace soft_robot_lab
