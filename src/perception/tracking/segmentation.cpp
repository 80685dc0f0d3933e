// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace soft_robot_lab {
namespace {

// OpenCV's HSV of bytes: hue in units of 2 degrees up to 179, the others up to 255.
constexpr int kMaxHue = 179;

int hue_byte(double hue_deg) { return std::min(kMaxHue, static_cast<int>(std::lround(hue_deg / 2))); }
int byte(double fraction) { return static_cast<int>(std::lround(fraction * 255)); }

void add_range(const cv::Mat& hsv, const HsvRange& range, int hue_min, int hue_max, cv::Mat& mask) {
  cv::Mat within;
  cv::inRange(hsv, cv::Scalar(hue_min, byte(range.saturation_min), byte(range.value_min)),
              cv::Scalar(hue_max, byte(range.saturation_max), byte(range.value_max)), within);
  cv::bitwise_or(mask, within, mask);
}

}  // namespace

cv::Mat colour_mask(const cv::Mat& hsv, const MarkerColour& colour) {
  cv::Mat mask = cv::Mat::zeros(hsv.size(), CV_8U);
  for (const HsvRange& range : colour.ranges) {
    const int min = hue_byte(range.hue_min_deg), max = hue_byte(range.hue_max_deg);
    if (range.hue_min_deg < range.hue_max_deg) {
      add_range(hsv, range, min, max, mask);
    } else {
      add_range(hsv, range, min, kMaxHue, mask);
      add_range(hsv, range, 0, max, mask);
    }
  }
  return mask;
}

cv::Mat contrast_mask(const cv::Mat& hsv, double value_threshold) {
  cv::Mat value, bright;
  cv::extractChannel(hsv, value, 2);
  cv::threshold(value, bright, byte(value_threshold), 255, cv::THRESH_BINARY);
  return with_holes_filled(bright) - bright;
}

cv::Mat with_holes_filled(const cv::Mat& mask) {
  // Whatever is reached from a frame of empty pixels around the mask is outside.
  cv::Mat framed;
  cv::copyMakeBorder(mask, framed, 1, 1, 1, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::floodFill(framed, cv::Point(0, 0), cv::Scalar(128));
  const cv::Mat inside = framed(cv::Rect(1, 1, mask.cols, mask.rows)) != 128;
  return inside.clone();
}

}  // namespace soft_robot_lab
