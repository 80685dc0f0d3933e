// SPDX-License-Identifier: BSD-3-Clause
#include "search_region.h"

#include <cmath>

namespace soft_robot_lab {

cv::Rect search_region(const TrackerCamera& camera, const std::vector<MarkerPrediction>& expected,
                       const TrackerSettings& settings) {
  constexpr double kDeviations = 3;
  const cv::Rect whole(0, 0, camera.model.width_px, camera.model.height_px);
  const Eigen::Isometry3d camera_from_world = camera.world_from_camera.inverse();
  cv::Rect region;
  for (const MarkerPrediction& marker : expected) {
    const Eigen::Vector3d in_camera = camera_from_world * marker.position_m;
    const double reach_m =
        kDeviations * std::sqrt(marker.covariance_m2.trace()) + settings.region_margin_m + settings.marker_radius_m;
    if (!(in_camera.z() > reach_m)) return whole;
    const Eigen::Vector2d pixel = camera.model.project(in_camera);
    const double reach_px = reach_m * camera.model.focal_x_px / in_camera.z();
    if (!(pixel.cwiseAbs().maxCoeff() + reach_px < 1e6)) return whole;
    const int size_px = static_cast<int>(std::ceil(2 * reach_px));
    const cv::Rect around(static_cast<int>(std::floor(pixel.x() - reach_px)),
                          static_cast<int>(std::floor(pixel.y() - reach_px)), size_px, size_px);
    region |= around & whole;
  }
  return region;
}

}  // namespace soft_robot_lab
