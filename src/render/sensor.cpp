#include "render/sensor.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace soft_robot_lab {
namespace {

enum Purpose : std::uint64_t { tile_of_white, tile_of_correlated, colour_noise, depth_noise, dark_blots };

constexpr float edge_jump_ratio = 0.02f;  // of the depth

}  // namespace

Sensor::Sensor(const SensorModel& model, cv::Size image_size, std::uint64_t seed) : model_(model), seed_(seed) {
  model_.validate();
  const double focal_px = 0.5 * image_size.width / std::tan(0.5 * model.field_of_view_deg * M_PI / 180);
  focal_baseline_px_m_ = static_cast<float>(focal_px * model.baseline_m);
  if (model.exposure_gain != 1 || model.light_gradient > 0) {
    brightness_.create(image_size, CV_32FC3);
    for (int u = 0; u < image_size.width; ++u)
      brightness_.col(u).setTo(
          cv::Scalar::all(model.exposure_gain * (1 - model.light_gradient * u / image_size.width)));
  }
  if (model.electrons_at_white > 0 || model.read_noise > 0)
    white_ = std::make_unique<NoiseTile>(scramble(seed, 0, tile_of_white), 0);
  if (model.disparity_noise_px > 0 || model.low_texture_level > 0)
    correlated_ = std::make_unique<NoiseTile>(scramble(seed, 0, tile_of_correlated), model.noise_correlation_px);
}

cv::Mat Sensor::colour(const ExactImage& exact, std::uint64_t frame) const {
  // Each stage into a matrix of its own: a cv::Mat assigned to would write into the exact picture.
  cv::Mat lit, blurred, noisy, image;
  if (brightness_.empty())
    lit = exact.colour;
  else
    cv::multiply(exact.colour, brightness_, lit);
  if (model_.blur_px > 0)
    cv::GaussianBlur(lit, blurred, {}, model_.blur_px, model_.blur_px, cv::BORDER_REPLICATE);
  else
    blurred = lit;
  if (white_) {
    blurred.copyTo(noisy);
    add_noise(noisy, frame);
  } else {
    noisy = blurred;
  }
  noisy.convertTo(image, CV_8UC3, 255);
  return image;
}

void Sensor::add_noise(cv::Mat& colour, std::uint64_t frame) const {
  const float read = static_cast<float>(model_.read_noise);
  const float photons = model_.electrons_at_white > 0 ? static_cast<float>(1 / model_.electrons_at_white) : 0;
  for (int v = 0; v < colour.rows; ++v) {
    // Another place for each row, lest channels repeat what the row above had.
    const NoiseTile::Window noise =
        white_->window(scramble(seed_, frame, colour_noise + (static_cast<std::uint64_t>(v) << 8)));
    float* values = colour.ptr<float>(v);
    for (int i = 0; i < 3 * colour.cols; ++i)
      values[i] += std::sqrt(std::max(values[i], 0.0f) * photons + read * read) * noise.at(i, i >> 10);
  }
}

cv::Mat Sensor::depth(const ExactImage& exact, std::uint64_t frame) const {
  const float noise_px = static_cast<float>(model_.disparity_noise_px);
  const float step_px = static_cast<float>(model_.disparity_step_px);
  cv::Mat image;
  if (noise_px == 0 && step_px == 0) {
    exact.depth.convertTo(image, CV_16UC1, 1000);
  } else {
    image.create(exact.depth.size(), CV_16UC1);
    const auto noise = correlated_ ? correlated_->window(scramble(seed_, frame, depth_noise)) : NoiseTile::Window{};
    for (int v = 0; v < image.rows; ++v)
      for (int u = 0; u < image.cols; ++u) {
        const float depth_m = exact.depth.at<float>(v, u);
        float disparity_px = focal_baseline_px_m_ / depth_m;  // infinite where nothing is met
        if (noise_px > 0) disparity_px += noise_px * noise.at(u, v);
        if (step_px > 0) disparity_px = step_px * std::nearbyint(disparity_px / step_px);
        const bool measured = depth_m > 0 && disparity_px > 0;
        image.at<std::uint16_t>(v, u) =
            measured ? cv::saturate_cast<std::uint16_t>(1000 * focal_baseline_px_m_ / disparity_px) : 0;
      }
  }
  if (model_.edge_hole_px > 0) punch_edges(exact.depth, image);
  if (model_.stereo_shadow) punch_shadows(exact.depth, image);
  if (model_.low_texture_level > 0) punch_dark(exact.colour, frame, image);
  return image;
}

void Sensor::punch_edges(const cv::Mat& exact_depth_m, cv::Mat& depth_mm) const {
  const int reach = static_cast<int>(std::ceil(model_.edge_hole_px));
  const int side = 2 * reach + 1;
  cv::Mat disc = cv::Mat::zeros(side, side, CV_8UC1), largest, least;
  for (int y = -reach; y <= reach; ++y)
    for (int x = -reach; x <= reach; ++x)
      disc.at<std::uint8_t>(y + reach, x + reach) = x * x + y * y <= model_.edge_hole_px * model_.edge_hole_px;
  cv::dilate(exact_depth_m, largest, disc);
  cv::erode(exact_depth_m, least, disc);
  depth_mm.setTo(0, largest - least > edge_jump_ratio * exact_depth_m);
}

// The second imager stands `baseline` to the right and sees a place at column u - disparity. Something nearer hides it
// where a place further right lands on the same column or left of it.
void Sensor::punch_shadows(const cv::Mat& exact_depth_m, cv::Mat& depth_mm) const {
  for (int v = 0; v < depth_mm.rows; ++v) {
    float leftmost_px = std::numeric_limits<float>::infinity();
    for (int u = depth_mm.cols - 1; u >= 0; --u) {
      const float depth_m = exact_depth_m.at<float>(v, u);
      const float landed_px = static_cast<float>(u) - (depth_m > 0 ? focal_baseline_px_m_ / depth_m : 0);
      if (landed_px > leftmost_px) depth_mm.at<std::uint16_t>(v, u) = 0;
      leftmost_px = std::min(leftmost_px, landed_px);
    }
  }
}

void Sensor::punch_dark(const cv::Mat& exact_colour, std::uint64_t frame, cv::Mat& depth_mm) const {
  const NoiseTile::Window noise = correlated_->window(scramble(seed_, frame, dark_blots));
  const float level = static_cast<float>(model_.low_texture_level);
  for (int v = 0; v < depth_mm.rows; ++v)
    for (int u = 0; u < depth_mm.cols; ++u) {
      const cv::Vec3f& colour = exact_colour.at<cv::Vec3f>(v, u);
      const float brightness = 0.299f * colour[0] + 0.587f * colour[1] + 0.114f * colour[2];
      // From one in two in the dark to the one in 700 that is three deviations off, at the level; none above.
      if (brightness < level && noise.at(u, v) > 3 * brightness / level) depth_mm.at<std::uint16_t>(v, u) = 0;
    }
}

}  // namespace soft_robot_lab
