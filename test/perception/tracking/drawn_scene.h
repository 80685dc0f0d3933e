// SPDX-License-Identifier: BSD-3-Clause
// Images with known truth: discs on patches of skin before the dark, ray-cast with 6 x 6 rays a pixel.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include "soft_robot_lab/perception/tracking/rgbd_frame.h"
#include "soft_robot_lab/perception/tracking/tracker_camera.h"

namespace soft_robot_lab::test {

const Eigen::Vector3d kSkin(200, 194, 184), kDark(8, 8, 8), kBlue(13, 38, 190), kRed(200, 20, 25);

// Mixes a disc into an rgb8 image, each pixel by its share within.
inline void draw_disc(cv::Mat& rgb, const Eigen::Vector2d& centre_px, double radius_px, const Eigen::Vector3d& colour) {
  constexpr int kRays = 16;
  for (int row = 0; row < rgb.rows; ++row)
    for (int column = 0; column < rgb.cols; ++column) {
      if ((Eigen::Vector2d(column, row) - centre_px).norm() > radius_px + 2) continue;
      int within = 0;
      for (int i = 0; i < kRays * kRays; ++i) {
        const Eigen::Vector2d ray((i % kRays + 0.5) / kRays - 0.5, (i / kRays + 0.5) / kRays - 0.5);
        within += (Eigen::Vector2d(column, row) + ray - centre_px).norm() < radius_px;
      }
      const double fraction = double(within) / (kRays * kRays);
      auto& pixel = rgb.at<cv::Vec3b>(row, column);
      for (int c = 0; c < 3; ++c)
        pixel[c] = static_cast<uchar>(std::lround(fraction * colour[c] + (1 - fraction) * pixel[c]));
    }
}

inline cv::Mat plain_image(int width_px, int height_px, const Eigen::Vector3d& colour) {
  return {height_px, width_px, CV_8UC3, cv::Scalar(colour[0], colour[1], colour[2])};
}

struct DrawnMarker {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = -Eigen::Vector3d::UnitY();
  Eigen::Vector3d colour = kBlue;
  double radius_m = 0.003;
  double skin_radius_m = 0.007;  // of the patch that it is painted on
};

// A camera at `position_m` whose axis meets `target_m`; the world's z is up.
inline TrackerCamera camera_at(const std::string& name, const Eigen::Vector3d& position_m,
                               const Eigen::Vector3d& target_m) {
  TrackerCamera camera;
  camera.name = name;
  camera.model = d415_camera(848, 480);
  const Eigen::Vector3d ahead = (target_m - position_m).normalized();
  const Eigen::Vector3d right = ahead.cross(Eigen::Vector3d::UnitZ()).normalized();
  camera.world_from_camera.linear() << right, ahead.cross(right), ahead;
  camera.world_from_camera.translation() = position_m;
  return camera;
}

// What a ray from the camera through a pixel meets first among the markers' patches.
struct Hit {
  double depth_m = 0;  // 0: nothing
  Eigen::Vector3d colour = kDark;
};

inline Hit cast(const TrackerCamera& camera, const Eigen::Vector2d& pixel, const std::vector<DrawnMarker>& markers) {
  const Eigen::Vector3d ray = camera.world_from_camera.linear() * camera.model.ray(pixel);
  Hit hit;
  for (const DrawnMarker& marker : markers) {
    const Eigen::Vector3d offset_m = marker.position_m - camera.world_from_camera.translation();
    const double depth_m = offset_m.dot(marker.normal) / ray.dot(marker.normal);
    const double from_middle_m = (depth_m * ray - offset_m).norm();
    if (!(depth_m > 0) || from_middle_m > marker.skin_radius_m || (hit.depth_m > 0 && hit.depth_m < depth_m)) continue;
    hit = {depth_m, from_middle_m < marker.radius_m ? marker.colour : kSkin};
  }
  return hit;
}

// Depth is rounded to millimetres, 0 before the dark.
inline RgbdFrame film(const TrackerCamera& camera, const std::vector<DrawnMarker>& markers, double stamp_s) {
  constexpr int kRays = 6;
  const CameraModel& model = camera.model;
  RgbdFrame frame{camera.name, stamp_s, plain_image(model.width_px, model.height_px, kDark),
                  cv::Mat::zeros(model.height_px, model.width_px, CV_32F), 0.001};
  cv::Mat near = cv::Mat::zeros(model.height_px, model.width_px, CV_8U);
  for (const DrawnMarker& marker : markers) {
    const Eigen::Vector3d in_camera = camera.world_from_camera.inverse() * marker.position_m;
    const Eigen::Vector2d pixel = model.project(in_camera);
    const int reach_px = static_cast<int>(marker.skin_radius_m * model.focal_x_px / in_camera.z()) + 3;
    const cv::Rect box(static_cast<int>(pixel.x()) - reach_px, static_cast<int>(pixel.y()) - reach_px, 2 * reach_px,
                       2 * reach_px);
    near(box & cv::Rect({0, 0}, near.size())) = 255;
  }
  for (int row = 0; row < near.rows; ++row)
    for (int column = 0; column < near.cols; ++column) {
      if (!near.at<uchar>(row, column)) continue;
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (int i = 0; i < kRays * kRays; ++i)
        sum += cast(camera, {column + (i % kRays + 0.5) / kRays - 0.5, row + (i / kRays + 0.5) / kRays - 0.5}, markers)
                   .colour;
      sum /= kRays * kRays;
      for (int c = 0; c < 3; ++c) frame.colour.at<cv::Vec3b>(row, column)[c] = static_cast<uchar>(std::lround(sum[c]));
      const Hit hit = cast(camera, {double(column), double(row)}, markers);
      frame.depth_m.at<float>(row, column) = static_cast<float>(1e-3 * std::round(1e3 * hit.depth_m));
    }
  return frame;
}

}  // namespace soft_robot_lab::test
