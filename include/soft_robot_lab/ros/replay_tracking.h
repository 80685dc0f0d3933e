#pragma once

#include <string>

#include "soft_robot_lab/ros/tracking_input.h"

namespace soft_robot_lab {

struct ReplaySummary {
  long written = 0;  // times all markers
  double cpu_s = 0;
};

// Tracks a recording in its own order, without waiting for any clock, and writes tracker/markers and reality_gap to a
// bag. Throws std::runtime_error where nothing of it could be used, and what rosbag throws.
ReplaySummary replay_tracking(const TrackingInputOptions& options, const std::string& bag, const std::string& output);

}  // namespace soft_robot_lab
