// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "soft_robot_lab/perception/tracking/tracker.h"

namespace soft_robot_lab {

// For a reader: why a tracker sees no marker in such a frame. Looks for what the markers look like, with red and blue
// exchanged too, for depths there, and for depths in another unit than metres, by where the markers rest.
std::string explain_unseen(const RgbdFrame& frame, const TrackerCamera& camera,
                           const std::vector<TrackedMarker>& markers, const TrackerSettings& settings);

}  // namespace soft_robot_lab
