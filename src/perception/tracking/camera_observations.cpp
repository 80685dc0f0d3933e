// SPDX-License-Identifier: BSD-3-Clause
#include "camera_observations.h"

#include <algorithm>

#include "marker_identity.h"

namespace soft_robot_lab {
namespace {

constexpr double kKnock_m = 0.01;  // standard deviation of where a displaced camera has the markers

bool tells_place(const MarkerDetection& sight) { return sight.depth_m && !sight.partial; }

std::vector<int> identify_widely(const std::vector<MarkerDetection>& sights, std::vector<MarkerPrediction> predictions,
                                 const std::vector<std::vector<int>>& neighbours, double gate) {
  for (MarkerPrediction& marker : predictions)
    marker.covariance_m2 += kKnock_m * kKnock_m * Eigen::Matrix3d::Identity();
  return identify(sights, predictions, neighbours, gate);
}

CameraObservation camera_observation(const MarkerDetection& sight, const MarkerPrediction& predicted) {
  CameraObservation seen;
  seen.camera = sight.camera->name;
  seen.measured_m = sight.point_m() - sight.later_s * predicted.velocity_m_s;
  const CameraModel& model = sight.camera->model;
  const Eigen::Vector3d sigma_m(*sight.depth_m / model.focal_x_px * sight.pixel_sigma,
                                *sight.depth_m / model.focal_y_px * sight.pixel_sigma, sight.depth_sigma_m);
  const Eigen::Matrix3d rotation = sight.camera->world_from_camera.linear();
  seen.covariance_m2 = rotation * sigma_m.cwiseAbs2().asDiagonal() * rotation.transpose();
  return seen;
}

}  // namespace

std::vector<std::optional<CameraObservation>> camera_observations(const std::vector<MarkerDetection>& sights,
                                                                  std::vector<int> chosen,
                                                                  const std::vector<MarkerPrediction>& predictions,
                                                                  const std::vector<std::vector<int>>& neighbours,
                                                                  double gate) {
  const auto usable = std::count_if(sights.begin(), sights.end(), tells_place);
  const auto found = std::count_if(chosen.begin(), chosen.end(), [](int sight) { return sight >= 0; });
  if (2 * found < std::min<std::ptrdiff_t>(usable, static_cast<std::ptrdiff_t>(chosen.size())))
    chosen = identify_widely(sights, predictions, neighbours, gate);
  std::vector<std::optional<CameraObservation>> seen(chosen.size());
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (chosen[i] < 0) continue;
    const MarkerDetection& sight = sights[static_cast<std::size_t>(chosen[i])];
    if (tells_place(sight)) seen[i] = camera_observation(sight, predictions[i]);
  }
  return seen;
}

}  // namespace soft_robot_lab
