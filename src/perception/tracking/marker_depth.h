// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include <opencv2/core/mat.hpp>

#include "marker_detector.h"

namespace soft_robot_lab {

// How far a marker's middle is along the camera's z.
struct MarkerDepth {
  double depth_m = 0;
  double sigma_m = 0;
  double slope_m_px = 0;  // by which it changes beside the blob's centre
  bool cut = false;       // something nearer stands at the blob's edge, so part of the marker is hidden
};

// From a depth image as RgbdFrame's: a plane through the depths of the blob's support at its centre, without those that
// do not belong to it (median absolute deviation). The inverse depth of a plane is linear in the pixel, so it is
// fitted. Nothing where fewer than 4 depths are left; zeros and values out of range count as not measured.
std::optional<MarkerDepth> measure_depth(const cv::Mat& depth_m, const MarkerBlob& blob, const DepthSettings& settings);

}  // namespace soft_robot_lab
