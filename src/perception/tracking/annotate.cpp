// SPDX-License-Identifier: BSD-3-Clause
#include "annotate.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <Eigen/Eigenvalues>
#include <opencv2/imgproc.hpp>

namespace soft_robot_lab {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kFontScale = 0.4;
constexpr int kFractionBits = 4;  // of drawn coordinates

const cv::Scalar kGreen(40, 220, 60), kOrange(255, 150, 20), kRed(255, 40, 40);

double radius_m(const MarkerObservation& marker, double marker_radius_m) {
  if (marker.source == MarkerSource::seen) return marker_radius_m;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(marker.covariance_m2, Eigen::EigenvaluesOnly);
  return std::max(marker_radius_m, 2 * std::sqrt(std::max(0.0, axes.eigenvalues().maxCoeff())));
}

void draw(const MarkerObservation& marker, const TrackerCamera& camera, double marker_radius_m, cv::Mat& image) {
  const Eigen::Vector3d in_camera = camera.world_from_camera.inverse() * marker.position_m;
  if (!(in_camera.z() > 0)) return;
  const Eigen::Vector2d pixel = camera.model.project(in_camera);
  if (!camera.model.sees(pixel)) return;
  const double radius_px = camera.model.focal_x_px * radius_m(marker, marker_radius_m) / in_camera.z() + 2;
  const bool seen = marker.source == MarkerSource::seen;
  const double unit = 1 << kFractionBits;
  const cv::Point centre(static_cast<int>(std::lround(unit * pixel.x())),
                         static_cast<int>(std::lround(unit * pixel.y())));
  cv::circle(image, centre, static_cast<int>(std::lround(unit * radius_px)), seen ? kGreen : kOrange, 1, cv::LINE_AA,
             kFractionBits);
  const cv::Point beside(static_cast<int>(pixel.x() + radius_px) + 3, static_cast<int>(pixel.y()) + 4);
  cv::putText(image, marker.name + (seen ? "" : " (interpolated)"), beside, kFont, kFontScale, seen ? kGreen : kOrange,
              1, cv::LINE_AA);
}

}  // namespace

cv::Mat annotate(const RgbdFrame& frame, const TrackerCamera& camera, const TrackerReport& report,
                 double marker_radius_m) {
  cv::Mat image = frame.colour.clone();
  for (const MarkerObservation& marker : report.markers) draw(marker, camera, marker_radius_m, image);
  int row = 16;
  for (const std::string& name : report.lost) {
    cv::putText(image, "lost: " + name, {8, row}, kFont, kFontScale, kRed, 1, cv::LINE_AA);
    row += 14;
  }
  return image;
}

}  // namespace soft_robot_lab
