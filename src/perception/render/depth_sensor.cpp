// SPDX-License-Identifier: BSD-3-Clause
#include "depth_sensor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/core/hal/intrin.hpp>
#include <opencv2/imgproc.hpp>

#include "rectangles.h"

namespace soft_robot_lab {
namespace {

constexpr std::uint64_t depth_tile = 1, depth_noise = 3, dark_blots = 4;  // purposes of chance; see scramble()
constexpr float edge_jump_ratio = 0.02f;                                  // of the depth
constexpr double finest_step_m = 1e-6;                                    // of a float of some metres

float focal_baseline_px_m(const SensorModel& model, int width_px) {
  const double focal_px = 0.5 * width_px / std::tan(0.5 * model.field_of_view_deg * M_PI / 180);
  return static_cast<float>(focal_px * model.baseline_m);
}

void read(const NoiseTile::Window& noise, int v, std::vector<float>& values) {
  constexpr int most = static_cast<int>(NoiseTile::size);
  const int count = static_cast<int>(values.size());
  for (int u = 0; u < count; u += most) noise.read(u, v, std::min(count - u, most), values.data() + u);
}

// Depths in steps to metres, each the nearest whole step; 0 where they are negative or infinite.
void round_to_steps(const float* steps, int count, float step_m, float* depth_m) {
  int i = 0;
#if CV_SIMD
  constexpr int lanes = cv::v_float32::nlanes;
  for (; i + lanes <= count; i += lanes) {  // infinity is rounded to the most negative number
    const cv::v_int32 whole = cv::v_max(cv::v_round(cv::vx_load(steps + i)), cv::vx_setzero_s32());
    cv::v_store(depth_m + i, cv::v_cvt_f32(whole) * cv::vx_setall_f32(step_m));
  }
#endif
  for (; i < count; ++i) depth_m[i] = steps[i] < 1e9f ? step_m * static_cast<float>(std::max(cvRound(steps[i]), 0)) : 0;
}

}  // namespace

DepthSensor::DepthSensor(const SensorModel& model, const ExactImage& background, std::uint64_t seed)
    : model_(model),
      seed_(seed),
      focal_baseline_px_m_(focal_baseline_px_m(model, background.depth.cols)),
      edge_reach_px_(static_cast<int>(std::ceil(model.edge_hole_px))),
      noisy_(model.disparity_noise_px > 0 || model.disparity_step_px > 0),
      rounded_(model.depth_step_m >= finest_step_m) {
  if (model.disparity_noise_px > 0 || model.low_texture_level > 0)
    correlated_ = std::make_unique<NoiseTile>(scramble(seed, 0, depth_tile), model.noise_correlation_px);
  const cv::Size size = background.depth.size();
  match_.disparity_px.create(size, CV_32FC1);
  if (!noisy_) match_.quiet_m.create(size, CV_32FC1);
  match_.edges.create(size, CV_8UC1);
  match_.holes.create(size, CV_8UC1);
  if (model.low_texture_level > 0) match_.blots.create(size, CV_32FC1);
  match(background, {{0, 0}, size});
  background_ = {match_.disparity_px.clone(), match_.quiet_m.clone(), match_.edges.clone(), match_.holes.clone(),
                 match_.blots.clone()};
}

cv::Mat DepthSensor::image(const ExactImage& exact, const cv::Rect& changed, std::uint64_t frame) {
  const auto restore = [&](const cv::Mat& from, cv::Mat& to) {
    if (!from.empty() && !changed_.empty()) from(changed_).copyTo(to(changed_));
  };
  restore(background_.disparity_px, match_.disparity_px);
  restore(background_.quiet_m, match_.quiet_m);
  restore(background_.edges, match_.edges);
  restore(background_.holes, match_.holes);
  restore(background_.blots, match_.blots);
  if (!changed.empty()) match(exact, changed);
  changed_ = grown(changed, edge_reach_px_) & cv::Rect({0, 0}, exact.depth.size());
  changed_.x = 0, changed_.width = exact.depth.cols;  // shadows fall far to the left

  cv::Mat image(exact.depth.size(), CV_32FC1);
  std::vector<float> values(static_cast<std::size_t>(image.cols));
  if (!noisy_) match_.quiet_m.copyTo(image);
  const auto noise = correlated_ ? correlated_->window(scramble(seed_, frame, depth_noise)) : NoiseTile::Window{};
  const auto blots = correlated_ ? correlated_->window(scramble(seed_, frame, dark_blots)) : NoiseTile::Window{};
  cv::Mat holes;
  for (int v = 0; v < image.rows; ++v) {
    if (noisy_) measure_row(v, noise, values, image);
    cv::Mat row = image.row(v);
    row.setTo(0, match_.holes.row(v));
    if (match_.blots.empty()) continue;
    read(blots, v, values);
    cv::compare(cv::Mat(1, image.cols, CV_32F, values.data()), match_.blots.row(v), holes, cv::CMP_GT);
    row.setTo(0, holes);
  }
  return image;
}

void DepthSensor::measure_row(int v, const NoiseTile::Window& noise, std::vector<float>& values, cv::Mat& image) const {
  cv::Mat disparity(1, image.cols, CV_32F, values.data());
  if (model_.disparity_noise_px > 0) {
    read(noise, v, values);
    cv::scaleAdd(disparity, model_.disparity_noise_px, match_.disparity_px.row(v), disparity);
  } else {
    match_.disparity_px.row(v).copyTo(disparity);
  }
  if (model_.disparity_step_px > 0) {
    cv::Mat steps;
    disparity.convertTo(steps, CV_32S, 1 / model_.disparity_step_px);
    steps.convertTo(disparity, CV_32F, model_.disparity_step_px);
  }
  // Infinite disparities become zero depths or negative ones, and those of zero infinite ones.
  if (rounded_) {
    cv::divide(static_cast<double>(focal_baseline_px_m_) / model_.depth_step_m, disparity, disparity);
    round_to_steps(values.data(), image.cols, static_cast<float>(model_.depth_step_m), image.ptr<float>(v));
  } else {
    cv::divide(static_cast<double>(focal_baseline_px_m_), disparity, image.row(v));
    image.row(v).setTo(0, (image.row(v) < 0) | (image.row(v) == std::numeric_limits<double>::infinity()));
  }
}

void DepthSensor::measure_quietly(const cv::Mat& exact_m, cv::Mat depth_m) const {
  if (!rounded_) return exact_m.copyTo(depth_m);
  const cv::Mat steps = exact_m / model_.depth_step_m;
  for (int v = 0; v < steps.rows; ++v)
    round_to_steps(steps.ptr<float>(v), steps.cols, static_cast<float>(model_.depth_step_m), depth_m.ptr<float>(v));
}

void DepthSensor::match(const ExactImage& exact, const cv::Rect& changed) {
  const cv::Mat depth_m = exact.depth(changed);
  cv::Mat disparity_px = match_.disparity_px(changed);
  for (int v = 0; v < changed.height; ++v)
    for (int u = 0; u < changed.width; ++u)
      disparity_px.at<float>(v, u) = focal_baseline_px_m_ / depth_m.at<float>(v, u);
  if (!noisy_) measure_quietly(depth_m, match_.quiet_m(changed));
  const cv::Rect reached = grown(changed, edge_reach_px_) & cv::Rect({0, 0}, exact.depth.size());
  find_edges(exact.depth, reached);
  match_.edges.rowRange(reached.y, reached.br().y).copyTo(match_.holes.rowRange(reached.y, reached.br().y));
  if (model_.stereo_shadow) find_shadows(reached.y, reached.br().y);
  if (model_.low_texture_level > 0) find_blots(exact.colour, changed);
}

void DepthSensor::find_edges(const cv::Mat& depth_m, const cv::Rect& area) {
  match_.edges(area).setTo(0);
  if (edge_reach_px_ == 0) return;
  const int side = 2 * edge_reach_px_ + 1;
  cv::Mat disc = cv::Mat::zeros(side, side, CV_8UC1), largest, least;
  for (int y = -edge_reach_px_; y <= edge_reach_px_; ++y)
    for (int x = -edge_reach_px_; x <= edge_reach_px_; ++x)
      disc.at<std::uint8_t>(y + edge_reach_px_, x + edge_reach_px_) =
          x * x + y * y <= model_.edge_hole_px * model_.edge_hole_px;
  cv::dilate(depth_m(area), largest, disc);  // both see what lies around a part of an image
  cv::erode(depth_m(area), least, disc);
  match_.edges(area).setTo(255, largest - least > edge_jump_ratio * depth_m(area));
}

// The second imager stands `baseline` to the right and sees a place at column u - disparity. Something nearer hides it
// where a place further right lands on the same column or left of it.
void DepthSensor::find_shadows(int first_row, int last_row) {
  for (int v = first_row; v < last_row; ++v) {
    const float* disparity_px = match_.disparity_px.ptr<float>(v);
    std::uint8_t* holes = match_.holes.ptr<std::uint8_t>(v);
    float leftmost_px = std::numeric_limits<float>::infinity();
    for (int u = match_.holes.cols - 1; u >= 0; --u) {
      const float landed_px = static_cast<float>(u) - (std::isinf(disparity_px[u]) ? 0 : disparity_px[u]);
      if (landed_px > leftmost_px) holes[u] = 255;
      leftmost_px = std::min(leftmost_px, landed_px);
    }
  }
}

// From one in two in the dark to the one in 700 that is three deviations off, at the level; none above.
void DepthSensor::find_blots(const cv::Mat& colour, const cv::Rect& area) {
  const float level = static_cast<float>(model_.low_texture_level);
  for (int v = area.y; v < area.br().y; ++v)
    for (int u = area.x; u < area.br().x; ++u) {
      const cv::Vec3f& pixel = colour.at<cv::Vec3f>(v, u);
      const float brightness = 0.299f * pixel[0] + 0.587f * pixel[1] + 0.114f * pixel[2];
      match_.blots.at<float>(v, u) =
          brightness < level ? 3 * brightness / level : std::numeric_limits<float>::infinity();
    }
}

}  // namespace soft_robot_lab
