// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include "soft_robot_lab/perception/tracking/tracker_settings.h"

namespace soft_robot_lab {

// 255 where a pixel's colour is within one of the ranges.
cv::Mat colour_mask(const cv::Mat& hsv, const MarkerColour& colour);

// 255 in holes of what is brighter than the threshold (value, [0, 1]): the thesis's contrast segmentation. A dark
// patch at the robot's outline is no hole, so a marker there is missed.
cv::Mat contrast_mask(const cv::Mat& hsv, double value_threshold);

// The mask with its own holes filled: highlights on a marker belong to it.
cv::Mat with_holes_filled(const cv::Mat& mask);

}  // namespace soft_robot_lab
