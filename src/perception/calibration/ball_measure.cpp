// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <opencv2/core.hpp>

#include "settings/quantile.h"
#include "camera_tuning.h"

namespace soft_robot_lab {
namespace {

constexpr double judged_share = 0.8;    // of a ball's radius
constexpr double min_radius_px = 5;     // with less there is no inside beside the edge
constexpr double clear_of_ball = 1.25;  // of its radius, and some pixels: what lies farther out is no ball's
constexpr int white = 250;              // of 255; noise and compression keep pixels from 255
constexpr double box_quantile = 0.95;

constexpr int directions = 72;
constexpr double profile_step_px = 0.1, profile_reach_px = 5;  // of a profile, to both sides of the outline
constexpr double profile_level_from_px = 3,
                 profile_min_contrast = 0.1;  // beside the edge levels are taken from here to the reach

cv::Mat brightest_channel(const cv::Mat& rgb) {
  std::array<cv::Mat, 3> channels;
  cv::split(rgb, channels.data());
  return cv::max(cv::max(channels[0], channels[1]), channels[2]);
}

double distance_px(const BallPlace& ball, int column, int row) {
  return (Eigen::Vector2d(column, row) - ball.centre_px).norm();
}

void require_usable(const cv::Mat& rgb, const std::vector<BallPlace>& balls) {
  if (rgb.type() != CV_8UC3) throw std::invalid_argument("measure_balls: the image is not rgb8 (CV_8UC3)");
  if (balls.empty()) throw std::invalid_argument("measure_balls: no ball; allowed: at least one");
  for (const BallPlace& ball : balls) {
    if (!(ball.radius_px >= min_radius_px))
      throw std::invalid_argument("measure_balls: a ball's radius is " + std::to_string(ball.radius_px) +
                                  " pixels; allowed: 5 or more");
    const Eigen::Vector2d middle = ball.centre_px;
    if (!(middle.x() >= 0 && middle.y() >= 0 && middle.x() <= rgb.cols - 1 && middle.y() <= rgb.rows - 1))
      throw std::invalid_argument("measure_balls: a ball's middle is outside the image");
  }
}

std::vector<double> inner_levels(const cv::Mat& level, const BallPlace& ball) {
  std::vector<double> levels;
  const int reach = static_cast<int>(std::ceil(ball.radius_px));
  const cv::Point middle(static_cast<int>(std::lround(ball.centre_px.x())),
                         static_cast<int>(std::lround(ball.centre_px.y())));
  for (int row = std::max(0, middle.y - reach); row <= std::min(level.rows - 1, middle.y + reach); ++row)
    for (int column = std::max(0, middle.x - reach); column <= std::min(level.cols - 1, middle.x + reach); ++column)
      if (distance_px(ball, column, row) <= judged_share * ball.radius_px)
        levels.push_back(level.at<uchar>(row, column));
  return levels;
}

double between_pixels(const cv::Mat& level, const Eigen::Vector2d& at) {
  const int column = static_cast<int>(at.x()), row = static_cast<int>(at.y());
  const double right = at.x() - column, down = at.y() - row;
  const uchar* above = level.ptr<uchar>(row) + column;
  const uchar* below = level.ptr<uchar>(row + 1) + column;
  return (1 - down) * ((1 - right) * above[0] + right * above[1]) + down * ((1 - right) * below[0] + right * below[1]);
}

// Brightness across the outline, from within to without; empty where the image ends.
std::vector<double> profile(const cv::Mat& level, const BallPlace& ball, double angle) {
  const Eigen::Vector2d outwards(std::cos(angle), std::sin(angle));
  std::vector<double> values;
  for (double beyond_px = -profile_reach_px; beyond_px <= profile_reach_px; beyond_px += profile_step_px) {
    const Eigen::Vector2d at = ball.centre_px + (ball.radius_px + beyond_px) * outwards;
    if (!(at.x() >= 0 && at.y() >= 0 && at.x() < level.cols - 1 && at.y() < level.rows - 1)) return {};
    values.push_back(between_pixels(level, at));
  }
  return values;
}

// How far it is from 90 to 10 % of the step.
std::optional<double> step_width_px(const std::vector<double>& profile) {
  const auto beside = static_cast<std::ptrdiff_t>((profile_reach_px - profile_level_from_px) / profile_step_px);
  if (static_cast<std::ptrdiff_t>(profile.size()) <= 2 * beside) return std::nullopt;
  const double within = median({profile.begin(), profile.begin() + beside});
  const double without = median({profile.end() - beside, profile.end()});
  if (within - without < profile_min_contrast * 255) return std::nullopt;
  const auto below = [&](double fraction) {
    return [=](double value) { return value < without + fraction * (within - without); };
  };
  const auto end = std::find_if(profile.begin(), profile.end(), below(0.1));
  auto begin = end;
  while (begin != profile.begin() && below(0.9)(*(begin - 1))) --begin;
  return static_cast<double>(end - begin) * profile_step_px;
}

std::optional<double> edge_width_px(const cv::Mat& level, const BallPlace& ball) {
  std::vector<double> widths_px;
  for (int i = 0; i < directions; ++i)
    if (const auto width = step_width_px(profile(level, ball, 2 * M_PI * i / directions))) widths_px.push_back(*width);
  if (widths_px.size() < directions / 2) return std::nullopt;
  return median(std::move(widths_px));
}

double box_level(const cv::Mat& level, const std::vector<BallPlace>& balls) {
  std::vector<double> levels;
  for (int row = 0; row < level.rows; ++row)
    for (int column = 0; column < level.cols; ++column) {
      const auto clear = [&](const BallPlace& ball) {
        return distance_px(ball, column, row) > clear_of_ball * ball.radius_px + profile_reach_px;
      };
      if (std::all_of(balls.begin(), balls.end(), clear)) levels.push_back(level.at<uchar>(row, column));
    }
  if (levels.empty()) throw std::invalid_argument("measure_balls: the image shows nothing but balls");
  return quantile(levels, box_quantile) / 255;
}

}  // namespace

BallPlace place_of(const FoundBall& ball, const CameraModel& camera) {
  const double distance_m = ball.center_m.norm();
  const double tangent = ball.radius_m / std::sqrt(distance_m * distance_m - ball.radius_m * ball.radius_m);
  return {camera.project(ball.center_m), 0.5 * (camera.focal_x_px + camera.focal_y_px) * tangent};
}

BallMeasure measure_balls(const cv::Mat& rgb, const std::vector<BallPlace>& balls) {
  require_usable(rgb, balls);
  const cv::Mat level = brightest_channel(rgb);
  BallMeasure worst;
  worst.darkest_level = 1;
  worst.edge_width_px = 0;
  for (const BallPlace& ball : balls) {
    std::vector<double> levels = inner_levels(level, ball);
    const auto saturated = std::count_if(levels.begin(), levels.end(), [](double value) { return value >= white; });
    worst.saturated_share = std::max(worst.saturated_share, double(saturated) / double(levels.size()));
    const double middle = median(std::move(levels)) / 255;
    worst.darkest_level = std::min(worst.darkest_level, middle);
    worst.brightest_level = std::max(worst.brightest_level, middle);
    const auto width_px = edge_width_px(level, ball);
    if (!width_px || !worst.edge_width_px)
      worst.edge_width_px = std::nullopt;
    else
      worst.edge_width_px = std::max(*worst.edge_width_px, *width_px);
  }
  worst.box_level = box_level(level, balls);
  return worst;
}

}  // namespace soft_robot_lab
