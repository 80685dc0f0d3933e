// SPDX-License-Identifier: BSD-3-Clause
// Does what a session's tracker did again, from the recorded images.
#pragma once

#include <vector>

#include <rosbag/bag.h>

#include "ros/tracking/tracking_input.h"

namespace soft_robot_lab {

struct RepeatedSteps {
  long without_images = 0;  // left out
  long resumed = 0;         // from the recorded state
};

// The tracker's numbers are changed where the session's were.

RepeatedSteps repeat_steps(const rosbag::Bag& bag, const std::vector<TrackerUpdateLog>& steps,
                           const TrackingInputOptions& options, const TrackingInput::OnResult& on_result);

}  // namespace soft_robot_lab
