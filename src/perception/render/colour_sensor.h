// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include "noise_tile.h"
#include "sensor_model.h"

namespace soft_robot_lab {

// A sensor's image of an exact picture's colours. All that does not depend on chance is kept of the background, and
// worked out anew only where the picture differs from it.
class ColourSensor {
 public:
  ColourSensor(const SensorModel& model, const cv::Mat& background, std::uint64_t seed);

  // CV_8UC3. `exact` is the background but for `changed`.
  cv::Mat image(const cv::Mat& exact, const cv::Rect& changed, std::uint64_t frame);

 private:
  struct Light {
    cv::Mat lit;        // CV_32FC3: with the exposure's gain
    cv::Mat mean;       // CV_32FC3: blurred
    cv::Mat deviation;  // CV_32FC3: of the noise; empty without any
    cv::Mat quiet;      // CV_8UC3: without noise; empty with it
  };
  void expose(const cv::Mat& exact, const cv::Rect& changed);
  cv::Mat noisy(std::uint64_t frame) const;

  SensorModel model_;
  std::uint64_t seed_;
  cv::Mat gain_;  // CV_32FC3, of each pixel; empty where all are 1
  std::unique_ptr<NoiseTile> white_;
  int reach_px_;  // of the blur
  Light background_, light_;
  cv::Rect changed_;  // where the two differ
};

}  // namespace soft_robot_lab
