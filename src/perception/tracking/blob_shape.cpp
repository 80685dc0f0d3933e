// SPDX-License-Identifier: BSD-3-Clause
#include "blob_shape.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/LU>
#include <opencv2/imgproc.hpp>

#include "settings/quantile.h"

namespace soft_robot_lab {
namespace {

constexpr double kFullScale = 255;
constexpr double kColourful = 0.1;  // of full scale: less chroma than this is judged by brightness

cv::Mat grown(const cv::Mat& mask, int reach_px) {
  cv::Mat wider;
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, cv::Size(2 * reach_px + 1, 2 * reach_px + 1));
  cv::dilate(mask, wider, disc);
  return wider;
}

cv::Mat shrunk(const cv::Mat& mask) {
  cv::Mat smaller;
  cv::erode(mask, smaller, cv::getStructuringElement(cv::MORPH_CROSS, cv::Size(3, 3)), cv::Point(-1, -1), 1,
            cv::BORDER_CONSTANT, cv::Scalar(0));
  return smaller;
}

Eigen::Vector3d pixel(const cv::Mat& rgb, int row, int column) {
  const auto& value = rgb.at<cv::Vec3b>(row, column);
  return {double(value[0]), double(value[1]), double(value[2])};
}

Eigen::Vector3d median_colour(const cv::Mat& rgb, const cv::Mat& where) {
  std::vector<double> channels[3];
  for (int row = 0; row < rgb.rows; ++row)
    for (int column = 0; column < rgb.cols; ++column)
      if (where.at<uchar>(row, column))
        for (int c = 0; c < 3; ++c) channels[c].push_back(rgb.at<cv::Vec3b>(row, column)[c]);
  if (channels[0].empty()) return Eigen::Vector3d::Zero();
  return {median(std::move(channels[0])), median(std::move(channels[1])), median(std::move(channels[2]))};
}

// The direction in RGB along which marker and background are distinguished, of length 1.
Eigen::Vector3d telling_direction(const Eigen::Vector3d& difference, SegmentationMethod method) {
  const Eigen::Vector3d chroma = difference.array() - difference.mean();
  const bool colourful = method == SegmentationMethod::colour && chroma.norm() > kColourful * kFullScale;
  return (colourful ? chroma : difference).stableNormalized();
}

struct Moments {
  double sum = 0;
  Eigen::Vector2d first = Eigen::Vector2d::Zero();
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();

  void add(const Eigen::Vector2d& at, double weight) {
    sum += weight;
    first += weight * at;
    second += weight * at * at.transpose();
  }
};

void fill_in(const Moments& moments, const DetectorSettings& settings, MarkerBlob& blob) {
  blob.area_px = moments.sum;
  blob.centre_px = moments.first / moments.sum;
  const Eigen::Matrix2d spread = moments.second / moments.sum - blob.centre_px * blob.centre_px.transpose();
  const double mean = 0.5 * spread.trace();
  const double offset = std::sqrt(std::max(0.0, mean * mean - spread.determinant()));
  blob.roundness = std::sqrt(std::max(0.0, mean - offset) / (mean + offset));
  const double outline_px = 2 * std::sqrt(M_PI * blob.area_px);
  const double edge_px = settings.edge_noise_px / std::max(blob.contrast, settings.min_contrast);
  blob.sigma_px = std::hypot(settings.centroid_floor_px, edge_px / std::sqrt(outline_px));
}

}  // namespace

void measure_blob(const BlobPatch& patch, const DetectorSettings& settings, MarkerBlob& blob) {
  cv::Mat core = shrunk(patch.own);
  if (cv::countNonZero(core) == 0) core = patch.own;
  const cv::Mat reach = grown(patch.own, 2) & ~patch.others;
  const cv::Mat around = grown(patch.own, kBlobMargin_px) & ~grown(patch.own, 2) & ~grown(patch.others, 1);
  const Eigen::Vector3d marker = median_colour(patch.rgb, core), background = median_colour(patch.rgb, around);
  const Eigen::Vector3d direction = telling_direction(marker - background, settings.method);
  const double range = direction.dot(marker - background);
  blob.contrast = range / kFullScale;
  blob.support = patch.own;
  if (!(range > 0)) return;
  Moments moments;
  for (int row = 0; row < reach.rows; ++row)
    for (int column = 0; column < reach.cols; ++column) {
      if (!reach.at<uchar>(row, column)) continue;
      const double fraction = direction.dot(pixel(patch.rgb, row, column) - background) / range;
      const double weight = core.at<uchar>(row, column) ? 1 : std::clamp(fraction, 0.0, 1.0);
      moments.add({double(column), double(row)}, weight);
    }
  fill_in(moments, settings, blob);
}

}  // namespace soft_robot_lab
