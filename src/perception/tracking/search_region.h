// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <opencv2/core/types.hpp>

#include "detection_fusion.h"

namespace soft_robot_lab {

// The part of a camera's image in which all markers are expected, with a margin of three standard deviations and of
// the settings'. The whole image where a marker is expected behind the camera.
cv::Rect search_region(const TrackerCamera& camera, const std::vector<MarkerPrediction>& expected,
                       const TrackerSettings& settings);

}  // namespace soft_robot_lab
