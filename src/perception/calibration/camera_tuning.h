// SPDX-License-Identifier: BSD-3-Clause
// Exposure and gain found by white balls in a dark box: the balls crisp, the box hardly to be seen.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "ball_finder.h"
#include "camera_setting.h"

namespace soft_robot_lab {

struct BallPlace {
  Eigen::Vector2d centre_px = Eigen::Vector2d::Zero();
  double radius_px = 0;
};

BallPlace place_of(const FoundBall& ball, const CameraModel& camera);

// Brightness is that of a pixel's brightest channel, in shares of white. Of several balls the worst.
struct BallMeasure {
  double darkest_level = 0, brightest_level = 0;  // of the balls: median within 0.8 of the radius
  double saturated_share = 0;                     // of these pixels: white in a channel
  std::optional<double> edge_width_px;            // of the outline, from 90 to 10 % of its step; none where none shows
  double box_level = 0;                           // all but the brightest twentieth of what is no ball is darker
};

// An rgb8 image. Throws std::invalid_argument: another type, no balls, a ball of less than 5 pixels' radius or outside
// the image, nothing but balls.
BallMeasure measure_balls(const cv::Mat& rgb, const std::vector<BallPlace>& balls);

struct TuningOptions {
  CameraSettingLimits limits{1, 300, 0, 128};  // longer exposures than 30 ms take frames
  double min_level = 0.5, max_level = 0.9;     // of balls, in [0, 1]
  double max_saturated_share = 0.01;           // of their pixels, in [0, 1]
  double max_box_level = 0.12;                 // (0, 1)
  double max_edge_width_px = 4;                // > 0
  int max_pictures = 40;                       // >= 1

  void validate() const;  // throws std::invalid_argument: field, value, allowed range
};

enum class TuningEnd {
  crisp,           // the balls are crisp and the box is dark
  ball_saturated,  // at the lowest settings
  ball_dark,       // at the highest
  box_bright,      // where the balls are not too dark
  blurred,         // balls are as bright as they should be, but have no sharp edge
  out_of_pictures
};

struct CameraTuning {
  TuningEnd end = TuningEnd::out_of_pictures;
  CameraSetting setting;  // the last tried; to be used where `end` is crisp
  BallMeasure measure;    // at that setting
  int pictures = 0;
  std::string message;  // why it ended, with the numbers; and what to do
};

// Looks for the longest exposure, and only where the longest is too short the largest gain, at which nothing is too
// bright. `look` takes a picture at a setting and measures it; what it throws ends the search.
CameraTuning tune_camera(const TuningOptions& options, const std::function<BallMeasure(const CameraSetting&)>& look);

}  // namespace soft_robot_lab
