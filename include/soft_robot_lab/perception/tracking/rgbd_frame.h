// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <opencv2/core/mat.hpp>

namespace soft_robot_lab {

// One picture of an RGB-D camera, depth aligned to colour: both as the colour camera sees them.
struct RgbdFrame {
  std::string camera;       // its name: the topics' first part
  double stamp_s = 0;       // session time of the exposure's middle
  cv::Mat colour;           // CV_8UC3, red first (rgb8)
  cv::Mat depth_m;          // CV_32FC1, along the camera's z; 0 where nothing was measured; of colour's size
  double depth_step_m = 0;  // depths are multiples of this; 0: they are not rounded
};

}  // namespace soft_robot_lab
