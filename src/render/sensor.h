// A sensor's two images of an exact picture.
#pragma once

#include <cstdint>
#include <memory>

#include <opencv2/core/mat.hpp>

#include "render/noise_tile.h"
#include "soft_robot_lab/render/exact_camera.h"
#include "soft_robot_lab/render/sensor_model.h"

namespace soft_robot_lab {

class Sensor {
 public:
  Sensor(const SensorModel& model, cv::Size image_size, std::uint64_t seed);

  cv::Mat colour(const ExactImage& exact, std::uint64_t frame) const;  // CV_8UC3
  cv::Mat depth(const ExactImage& exact, std::uint64_t frame) const;   // CV_16UC1 [mm]

 private:
  void add_noise(cv::Mat& colour, std::uint64_t frame) const;
  void punch_edges(const cv::Mat& exact_depth_m, cv::Mat& depth_mm) const;
  void punch_shadows(const cv::Mat& exact_depth_m, cv::Mat& depth_mm) const;
  void punch_dark(const cv::Mat& exact_colour, std::uint64_t frame, cv::Mat& depth_mm) const;

  SensorModel model_;
  std::uint64_t seed_;
  float focal_baseline_px_m_;
  cv::Mat brightness_;                             // CV_32FC3, gain of each pixel; empty where all are 1
  std::unique_ptr<NoiseTile> white_, correlated_;  // as far as needed
};

}  // namespace soft_robot_lab
