// SPDX-License-Identifier: BSD-3-Clause
#include "colour_sensor.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "rectangles.h"

namespace soft_robot_lab {
namespace {

constexpr std::uint64_t colour_tile = 0, colour_noise = 2;  // purposes of chance; see scramble()
constexpr int tile_size = static_cast<int>(NoiseTile::size);
constexpr double blur_reach = 5;  // deviations, at which OpenCV's kernel has ended

}  // namespace

ColourSensor::ColourSensor(const SensorModel& model, const cv::Mat& background, std::uint64_t seed)
    : model_(model),
      seed_(seed),
      reach_px_(model.blur_px > 0 ? static_cast<int>(std::ceil(blur_reach * model.blur_px)) + 1 : 0) {
  const cv::Size size = background.size();
  if (model.exposure_gain != 1 || model.light_gradient > 0) {
    gain_.create(size, CV_32FC3);
    for (int u = 0; u < size.width; ++u)
      gain_.col(u).setTo(cv::Scalar::all(model.exposure_gain * (1 - model.light_gradient * u / size.width)));
  }
  if (model.electrons_at_white > 0 || model.read_noise > 0)
    white_ = std::make_unique<NoiseTile>(scramble(seed, 0, colour_tile), 0);
  light_.lit.create(size, CV_32FC3);
  light_.mean.create(size, CV_32FC3);
  if (white_)
    light_.deviation.create(size, CV_32FC3);
  else
    light_.quiet.create(size, CV_8UC3);
  expose(background, {{0, 0}, size});
  background_ = {light_.lit.clone(), light_.mean.clone(), light_.deviation.clone(), light_.quiet.clone()};
}

cv::Mat ColourSensor::image(const cv::Mat& exact, const cv::Rect& changed, std::uint64_t frame) {
  const auto restore = [&](const cv::Mat& from, cv::Mat& to) {
    if (!from.empty() && !changed_.empty()) from(changed_).copyTo(to(changed_));
  };
  restore(background_.lit, light_.lit);
  restore(background_.mean, light_.mean);
  restore(background_.deviation, light_.deviation);
  restore(background_.quiet, light_.quiet);
  if (!changed.empty()) expose(exact, changed);
  changed_ = grown(changed, reach_px_) & cv::Rect({0, 0}, exact.size());
  return white_ ? noisy(frame) : light_.quiet.clone();
}

void ColourSensor::expose(const cv::Mat& exact, const cv::Rect& changed) {
  const cv::Rect reached = grown(changed, reach_px_) & cv::Rect({0, 0}, exact.size());
  cv::Mat lit = light_.lit(changed), mean = light_.mean(reached);
  if (gain_.empty())
    exact(changed).copyTo(lit);
  else
    cv::multiply(exact(changed), gain_(changed), lit);
  if (model_.blur_px > 0)  // sees what lies around a part of an image
    cv::GaussianBlur(light_.lit(reached), mean, {}, model_.blur_px, model_.blur_px, cv::BORDER_REPLICATE);
  else
    light_.lit(reached).copyTo(mean);
  if (!white_) {
    mean.convertTo(light_.quiet(reached), CV_8UC3, 255);
    return;
  }
  const double photons = model_.electrons_at_white > 0 ? 1 / model_.electrons_at_white : 0;
  cv::Mat variance;
  cv::max(mean, 0.0, variance);
  variance.convertTo(variance, CV_32F, photons, model_.read_noise * model_.read_noise);
  cv::Mat deviation = light_.deviation(reached);
  cv::sqrt(variance, deviation);
}

cv::Mat ColourSensor::noisy(std::uint64_t frame) const {
  cv::Mat image(light_.mean.size(), CV_8UC3);
  const int count = 3 * image.cols;
  std::vector<float> values(static_cast<std::size_t>(count));
  cv::Mat row(1, count, CV_32F, values.data());
  for (int v = 0; v < image.rows; ++v) {
    // Another place for each row, lest channels repeat what the row above had.
    const NoiseTile::Window noise =
        white_->window(scramble(seed_, frame, colour_noise + (static_cast<std::uint64_t>(v) << 8)));
    for (int i = 0; i < count; i += tile_size)
      noise.read(i, i / tile_size, std::min(count - i, tile_size), values.data() + i);
    cv::multiply(row, light_.deviation.row(v).reshape(1), row);
    cv::add(row, light_.mean.row(v).reshape(1), row);
    row.convertTo(image.row(v).reshape(1), CV_8U, 255);
  }
  return image;
}

}  // namespace soft_robot_lab
