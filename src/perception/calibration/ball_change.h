// SPDX-License-Identifier: BSD-3-Clause
// What changed between two series of pictures.
#pragma once

#include "ball_finder.h"

namespace soft_robot_lab {

struct BallChange {
  cv::Mat brightness;   // CV_32FC1: by how much brighter it became, in shares of white
  cv::Mat depth_m;      // CV_32FC1: with balls, 0 where nothing was measured
  cv::Mat mask;         // CV_8UC1: 255 where something came
  int depth_count = 1;  // pictures that the depths are the mean of
};

// Throws std::invalid_argument as find_balls() does.
BallChange find_change(const std::vector<RgbdFrame>& without_balls, const std::vector<RgbdFrame>& with_balls,
                       const CameraModel& camera, const BallFinderSettings& settings);

}  // namespace soft_robot_lab
