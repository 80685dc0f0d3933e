// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include "soft_robot_lab/perception/tracking/tracker.h"

namespace soft_robot_lab {

// A copy of the frame's colour image with each marker's place and name: green circles where it is seen, orange ones
// with the radius of two standard deviations where it is interpolated, and a list of the lost ones.
cv::Mat annotate(const RgbdFrame& frame, const TrackerCamera& camera, const TrackerReport& report,
                 double marker_radius_m);

}  // namespace soft_robot_lab
