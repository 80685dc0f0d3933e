// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "marker_detector.h"
#include "soft_robot_lab/perception/tracking/rgbd_frame.h"
#include "soft_robot_lab/perception/tracking/tracker_camera.h"

namespace soft_robot_lab {

// Something that looks like a marker, as one camera measures it.
struct MarkerDetection {
  const TrackerCamera* camera = nullptr;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double pixel_sigma = 0;
  std::optional<double> depth_m;  // along the camera's z
  double depth_sigma_m = 0;
  double later_s = 0;  // exposed so much later than the time positions are wanted at
  int colour = -1;     // -1: unknown
  bool partial = false;

  Eigen::Vector3d point_m() const;  // in the world; only with a depth
};

// Everything in the region that looks like a marker. What is seen in part, or is larger than a marker at its depth
// (two in one), has its uncertainty widened to half the blob's radius.
std::vector<MarkerDetection> look(const RgbdFrame& frame, const TrackerCamera& camera, const cv::Rect& region,
                                  double time_s, const TrackerSettings& settings);

}  // namespace soft_robot_lab
