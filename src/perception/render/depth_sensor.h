// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include "noise_tile.h"
#include "exact_camera.h"
#include "sensor_model.h"

namespace soft_robot_lab {

// A stereo sensor's depth of an exact picture. All that does not depend on chance is kept of the background, and worked
// out anew only where the picture differs from it.
class DepthSensor {
 public:
  DepthSensor(const SensorModel& model, const ExactImage& background, std::uint64_t seed);

  // As RgbdFrame's depth_m. `exact` is the background but for `changed`.
  cv::Mat image(const ExactImage& exact, const cv::Rect& changed, std::uint64_t frame);

 private:
  struct Match {
    cv::Mat disparity_px;  // CV_32FC1, infinite where nothing is met
    cv::Mat quiet_m;       // CV_32FC1, as it is measured without noise; only of a sensor that has none
    cv::Mat edges;         // CV_8UC1: 255 beside a jump of depth
    cv::Mat holes;         // CV_8UC1: 255 at edges and in shadows
    cv::Mat blots;         // CV_32FC1: noise above this makes a hole in the dark; infinite where it is light
  };
  void match(const ExactImage& exact, const cv::Rect& changed);
  void find_edges(const cv::Mat& depth_m, const cv::Rect& area);
  void find_shadows(int first_row, int last_row);
  void find_blots(const cv::Mat& colour, const cv::Rect& area);
  void measure_row(int v, const NoiseTile::Window& noise, std::vector<float>& values, cv::Mat& image) const;
  void measure_quietly(const cv::Mat& exact_m, cv::Mat depth_m) const;

  SensorModel model_;
  std::uint64_t seed_;
  float focal_baseline_px_m_;
  int edge_reach_px_;
  bool noisy_;    // its disparities
  bool rounded_;  // its depths
  std::unique_ptr<NoiseTile> correlated_;
  Match background_, match_;
  cv::Rect changed_;  // where the two differ
};

}  // namespace soft_robot_lab
