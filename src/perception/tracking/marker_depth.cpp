// SPDX-License-Identifier: BSD-3-Clause
#include "marker_depth.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Cholesky>
#include <opencv2/imgproc.hpp>

#include "settings/quantile.h"

namespace soft_robot_lab {
namespace {

constexpr std::size_t kFewest = 4;
constexpr double kRejection = 3;                  // standard deviations
constexpr double kFromMedianDeviation = 1.4826;   // standard deviation of a normal distribution
constexpr double kUniform = 0.28867513459481287;  // standard deviation of a uniform one of width 1

struct Sample {
  Eigen::Vector3d basis;  // 1 and the pixel from the blob's centre
  double depth_m;
};

double noise_m(double depth_m, const DepthSettings& settings) {
  return std::hypot(settings.noise_per_m * depth_m * depth_m, kUniform * settings.quantisation_m);
}

std::vector<Sample> samples_in(const cv::Mat& depth_m, const cv::Mat& where, const MarkerBlob& blob,
                               const DepthSettings& settings) {
  std::vector<Sample> samples;
  for (int row = 0; row < where.rows; ++row)
    for (int column = 0; column < where.cols; ++column) {
      if (!where.at<uchar>(row, column)) continue;
      const int y = blob.box.y + row, x = blob.box.x + column;
      const double here_m = static_cast<double>(depth_m.at<float>(y, x));
      if (!(here_m >= settings.min_m && here_m <= settings.max_m)) continue;
      samples.push_back({{1, x - blob.centre_px.x(), y - blob.centre_px.y()}, here_m});
    }
  return samples;
}

// Inverse depth over the pixel, and how well its value at the centre is known.
struct Plane {
  Eigen::Vector3d coefficients = Eigen::Vector3d::Zero();
  double centre_variance = 0;  // of one sample's variance
  double depth_at(const Eigen::Vector3d& basis) const { return 1 / coefficients.dot(basis); }
};

Plane fit(const std::vector<Sample>& samples) {
  // A weak belief that the marker faces the camera, worth one sample a pixel off the centre, keeps a fit to
  // samples in a row from running away.
  Eigen::Matrix3d normal = Eigen::Vector3d(0, 1, 1).asDiagonal();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const Sample& sample : samples) {
    normal += sample.basis * sample.basis.transpose();
    right += sample.basis / sample.depth_m;
  }
  const Eigen::LDLT<Eigen::Matrix3d> factor(normal);
  return {factor.solve(right), factor.solve(Eigen::Vector3d::UnitX()).x()};
}

// Keeps what lies within the limit of the plane, or of the median deviation where that is more.
std::vector<Sample> without_outliers(const std::vector<Sample>& samples, const Plane& plane, double limit_m) {
  std::vector<double> misses;
  for (const Sample& sample : samples) misses.push_back(std::abs(sample.depth_m - plane.depth_at(sample.basis)));
  const double allowed_m = std::max(limit_m, kRejection * kFromMedianDeviation * median(misses));
  std::vector<Sample> kept;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (misses[i] <= allowed_m) kept.push_back(samples[i]);
  return kept;
}

Plane facing_plane(const std::vector<Sample>& samples) {
  std::vector<double> depths;
  for (const Sample& sample : samples) depths.push_back(sample.depth_m);
  return {{1 / median(std::move(depths)), 0, 0}, 1};
}

// Quantisation errors of neighbours are alike unless the surface crosses steps of it within the blob.
double quantisation_m(const std::vector<Sample>& samples, const DepthSettings& settings) {
  if (settings.quantisation_m == 0) return 0;
  const auto [low, high] = std::minmax_element(samples.begin(), samples.end(),
                                               [](const Sample& a, const Sample& b) { return a.depth_m < b.depth_m; });
  const double steps = (high->depth_m - low->depth_m) / settings.quantisation_m;
  return kUniform * settings.quantisation_m / std::max(1.0, steps);
}

double sigma_of(const std::vector<Sample>& samples, const Plane& plane, double depth_m, const DepthSettings& settings) {
  double miss_2 = 0;
  for (const Sample& sample : samples) miss_2 += std::pow(sample.depth_m - plane.depth_at(sample.basis), 2);
  const double seen_m = std::sqrt(miss_2 / static_cast<double>(samples.size()));
  const double model_m = settings.noise_per_m * depth_m * depth_m;
  const double alike = std::min(settings.correlation_px * settings.correlation_px, 1 / plane.centre_variance);
  return std::hypot(std::max(seen_m, model_m) * std::sqrt(plane.centre_variance * std::max(1.0, alike)),
                    quantisation_m(samples, settings));
}

// Whether a good part of what surrounds the support is nearer than the plane by more than noise and relief.
bool cut_by_something_nearer(const cv::Mat& depth_m, const MarkerBlob& blob, const Plane& plane, double limit_m,
                             const DepthSettings& settings) {
  constexpr double kShare = 0.12;
  cv::Mat wider;
  cv::dilate(blob.support, wider, cv::getStructuringElement(cv::MORPH_ELLIPSE, cv::Size(5, 5)));
  const auto around = samples_in(depth_m, wider & ~blob.support, blob, settings);
  const auto nearer = std::count_if(around.begin(), around.end(), [&](const Sample& sample) {
    return sample.depth_m < plane.depth_at(sample.basis) - limit_m;
  });
  return static_cast<double>(nearer) > kShare * static_cast<double>(around.size());
}

}  // namespace

std::optional<MarkerDepth> measure_depth(const cv::Mat& depth_m, const MarkerBlob& blob,
                                         const DepthSettings& settings) {
  constexpr double kRelief_m = 0.004;
  std::vector<Sample> samples = samples_in(depth_m, blob.support, blob, settings);
  if (samples.size() < kFewest) return std::nullopt;
  Plane plane = facing_plane(samples);
  const double limit_m = kRejection * noise_m(plane.depth_at(Eigen::Vector3d::UnitX()), settings);
  samples = without_outliers(samples, plane, limit_m + kRelief_m);
  for (int round = 0; round < 3 && samples.size() >= kFewest; ++round) {
    plane = fit(samples);
    samples = without_outliers(samples, plane, limit_m);
  }
  if (samples.size() < kFewest) return std::nullopt;
  MarkerDepth result;
  result.depth_m = plane.depth_at(Eigen::Vector3d::UnitX());
  if (!(result.depth_m >= settings.min_m && result.depth_m <= settings.max_m)) return std::nullopt;
  result.slope_m_px = plane.coefficients.tail<2>().norm() * result.depth_m * result.depth_m;
  result.sigma_m = sigma_of(samples, plane, result.depth_m, settings);
  result.cut = cut_by_something_nearer(depth_m, blob, plane, limit_m + kRelief_m, settings);
  return result;
}

}  // namespace soft_robot_lab
