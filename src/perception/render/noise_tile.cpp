// SPDX-License-Identifier: BSD-3-Clause
#include "noise_tile.h"

#include <cmath>
#include <random>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace soft_robot_lab {

std::uint64_t scramble(std::uint64_t seed, std::uint64_t frame, std::uint64_t purpose) {
  std::uint64_t mixed = 0;
  for (const std::uint64_t part : {seed, frame, purpose}) {
    mixed += part + 0x9e3779b97f4a7c15u;
    mixed = (mixed ^ mixed >> 30) * 0xbf58476d1ce4e5b9u;
    mixed = (mixed ^ mixed >> 27) * 0x94d049bb133111ebu;
    mixed ^= mixed >> 31;
  }
  return mixed;
}

NoiseTile::NoiseTile(std::uint64_t seed, double correlation_px) : values_(size * size) {
  std::mt19937_64 random(seed);
  std::normal_distribution<float> normal;
  for (float& value : values_) value = normal(random);
  if (correlation_px <= 0) return;
  cv::Mat tile(size, size, CV_32FC1, values_.data());
  const int border = static_cast<int>(std::ceil(4 * correlation_px));
  cv::Mat wide;
  cv::copyMakeBorder(tile, wide, border, border, border, border, cv::BORDER_WRAP);
  cv::GaussianBlur(wide, wide, {2 * border + 1, 2 * border + 1}, correlation_px);
  cv::Mat blurred = wide(cv::Rect(border, border, tile.cols, tile.rows));
  cv::Scalar mean, deviation;
  cv::meanStdDev(blurred, mean, deviation);
  tile = (blurred - mean[0]) / deviation[0];
}

NoiseTile::Window NoiseTile::window(std::uint64_t place) const {
  Window window;
  window.values_ = values_.data();
  window.right_ = place & mask;
  window.down_ = place >> 32 & mask;
  return window;
}

}  // namespace soft_robot_lab
