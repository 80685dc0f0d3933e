// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include "ros/tracking/tracking_input.h"

namespace soft_robot_lab {

struct ReplaySummary {
  long written = 0;                  // times all markers
  std::map<std::string, long> seen;  // of them, those at which cameras saw this marker
  std::vector<std::string> notes;    // on cameras of which not all could be used
  double cpu_s = 0;

  // Where the recording has the steps of its session's tracker:
  bool repeated = false;
  long markers_alike = 0, markers_other = 0;  // as the session's to the last digit, and not
  long gaps_alike = 0, gaps_other = 0;
  long without_images = 0;  // steps left out, as the recording lacks an image
  long resumed = 0;         // steps from the recorded state, as the one before is not known: mostly just the first
};

// Tracks a recording without waiting for any clock, and writes tracker/markers and reality_gap to a bag: step by step
// as the session's tracker did (tracker/steps), which takes nothing but the tracker's settings from the options; or, of
// bare cameras, in the recording's own order, colour and depth paired within the options' tolerance. Throws
// std::runtime_error where nothing of it could be used or no marker was ever seen, each with the reason, and what
// rosbag throws. There is no output then.
ReplaySummary replay_tracking(const TrackingInputOptions& options, const std::string& bag, const std::string& output);

}  // namespace soft_robot_lab
