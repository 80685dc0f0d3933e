// SPDX-License-Identifier: BSD-3-Clause
#include "marker_detection.h"

#include <cmath>

#include "marker_depth.h"

namespace soft_robot_lab {
namespace {

constexpr double kTwoInOne = 1.6;  // of the area of a marker that faces the camera

double facing_area_px(const CameraModel& model, double depth_m, double radius_m) {
  return M_PI * radius_m * radius_m * model.focal_x_px * model.focal_y_px / (depth_m * depth_m);
}

}  // namespace

Eigen::Vector3d MarkerDetection::point_m() const {
  return camera->world_from_camera * (*depth_m * camera->model.ray(pixel));
}

std::vector<MarkerDetection> look(const RgbdFrame& frame, const TrackerCamera& camera, const cv::Rect& region,
                                  double time_s, const TrackerSettings& settings) {
  std::vector<MarkerDetection> sights;
  for (const MarkerBlob& blob : detect_markers(frame.colour, region, settings.detector)) {
    MarkerDetection sight;
    sight.camera = &camera;
    sight.pixel = blob.centre_px;
    sight.pixel_sigma = blob.sigma_px;
    sight.colour = blob.colour;
    sight.partial = blob.partial;
    const double row = blob.centre_px.y() / camera.model.height_px;
    sight.later_s = frame.stamp_s + (row - 0.5) * settings.readout_s - time_s;
    double slope_m_px = 0;
    if (const auto depth = measure_depth(frame.depth_m, blob, settings.depth)) {
      sight.depth_m = depth->depth_m;
      sight.depth_sigma_m = depth->sigma_m;
      slope_m_px = depth->slope_m_px;
      sight.partial |= depth->cut || blob.area_px > kTwoInOne * facing_area_px(camera.model, depth->depth_m,
                                                                               settings.marker_radius_m);
    }
    if (sight.partial) {
      const double beside_px = 0.5 * std::sqrt(blob.area_px / M_PI);
      sight.pixel_sigma = std::hypot(sight.pixel_sigma, beside_px);
      sight.depth_sigma_m = std::hypot(sight.depth_sigma_m, slope_m_px * beside_px);
    }
    sights.push_back(sight);
  }
  return sights;
}

}  // namespace soft_robot_lab
