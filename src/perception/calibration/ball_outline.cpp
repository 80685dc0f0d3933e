// SPDX-License-Identifier: BSD-3-Clause
#include "ball_outline.h"

#include <array>
#include <cmath>
#include <optional>

#include <Eigen/Geometry>

namespace soft_robot_lab {
namespace {

constexpr double step_px = 0.25, reach_px = 5;
constexpr int sample_count = 41;                          // from -reach (within) to reach (without)
constexpr double level_from_px = 1.5, level_to_px = 2.5;  // from the edge: where the levels beside it are taken

using Profile = std::array<double, sample_count>;

std::optional<double> sample(const cv::Mat& image, const Eigen::Vector2d& pixel) {
  if (!(pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < image.cols - 1 && pixel.y() < image.rows - 1))
    return std::nullopt;
  const int u = static_cast<int>(pixel.x()), v = static_cast<int>(pixel.y());
  const double right = pixel.x() - u, down = pixel.y() - v;
  const float* above = image.ptr<float>(v) + u;
  const float* below = image.ptr<float>(v + 1) + u;
  return (1 - down) * ((1 - right) * above[0] + right * above[1]) + down * ((1 - right) * below[0] + right * below[1]);
}

std::optional<Profile> sample_profile(const cv::Mat& image, const Eigen::Vector2d& middle,
                                      const Eigen::Vector2d& outwards) {
  Profile profile;
  for (int i = 0; i < sample_count; ++i) {
    const auto value = sample(image, middle + (i * step_px - reach_px) * outwards);
    if (!value) return std::nullopt;
    profile[static_cast<std::size_t>(i)] = *value;
  }
  return profile;
}

double mean(const Profile& profile, int first, int last) {
  double sum = 0;
  for (int i = first; i <= last; ++i) sum += profile[static_cast<std::size_t>(i)];
  return sum / (last - first + 1);
}

// The place of the steepest step, then of half its height [px from the middle].
std::optional<double> find_edge(const Profile& profile, double min_contrast) {
  constexpr int near = static_cast<int>(level_from_px / step_px), far = static_cast<int>(level_to_px / step_px);
  int edge = -1;
  double contrast = 0, middle_level = 0;
  for (int i = far; i + far < sample_count; ++i) {
    const double within = mean(profile, i - far, i - near), without = mean(profile, i + near, i + far);
    if (std::abs(within - without) > std::abs(contrast)) {
      edge = i;
      contrast = within - without;
      middle_level = 0.5 * (within + without);
    }
  }
  if (edge < 0 || std::abs(contrast) < min_contrast) return std::nullopt;
  for (int i = edge - near; i < edge + near; ++i) {
    const double here = profile[static_cast<std::size_t>(i)] - middle_level;
    const double next = profile[static_cast<std::size_t>(i + 1)] - middle_level;
    if (here * contrast >= 0 && next * contrast < 0) return (i + here / (here - next)) * step_px - reach_px;
  }
  return std::nullopt;
}

}  // namespace

std::vector<Eigen::Vector2d> find_outline(const cv::Mat& brightness, const CameraModel& camera,
                                          const Eigen::Vector3d& center_m, double radius_m, double min_contrast) {
  const Eigen::Vector3d ahead = center_m.normalized();
  const Eigen::Vector3d right = ahead.unitOrthogonal(), down = ahead.cross(right);
  const double half_angle = std::asin(radius_m / center_m.norm());
  std::vector<Eigen::Vector2d> outline;
  for (int i = 0; i < outline_directions; ++i) {
    const double turn = 2 * M_PI * i / outline_directions;
    const Eigen::Vector3d aside = std::cos(turn) * right + std::sin(turn) * down;
    const auto pixel = [&](double angle) { return camera.project(std::cos(angle) * ahead + std::sin(angle) * aside); };
    const Eigen::Vector2d middle = pixel(half_angle);
    const Eigen::Vector2d outwards = (pixel(1.01 * half_angle) - middle).normalized();
    const auto profile = sample_profile(brightness, middle, outwards);
    if (!profile) continue;
    if (const auto edge = find_edge(*profile, min_contrast)) outline.push_back(middle + *edge * outwards);
  }
  return outline;
}

}  // namespace soft_robot_lab
