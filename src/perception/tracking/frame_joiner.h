// SPDX-License-Identifier: BSD-3-Clause
// Brings the frames of several cameras together that were taken at about one time.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "soft_robot_lab/perception/tracking/rgbd_frame.h"

namespace soft_robot_lab {

// Goes by stamps alone, so that a recording is joined as the session was, however fast it is played: a group holds at
// most one frame of each camera, taken within `sync_tolerance_s` of its oldest, and is ready once every camera has sent
// that frame or a newer one, or somebody has sent one that is `sync_timeout_s` newer than the oldest: the others are
// silent.
class FrameJoiner {
 public:
  // Throws std::invalid_argument: no cameras, sync_tolerance_s or sync_timeout_s below 0.
  FrameJoiner(const std::vector<std::string>& cameras, double sync_tolerance_s, double sync_timeout_s);

  // The groups that are ready now, oldest first. A frame that comes after newer ones of its camera makes a group of its
  // own. Throws std::invalid_argument for a camera that it does not know.
  std::vector<std::vector<RgbdFrame>> add(RgbdFrame frame);
  // What still waits, at the end of a recording.
  std::vector<std::vector<RgbdFrame>> finish();
  // For a clock that goes back.
  void reset();

 private:
  std::optional<double> oldest_s() const;
  bool ready(double oldest_s) const;
  std::vector<RgbdFrame> take(double oldest_s);

  double slop_s_, patience_s_;
  std::map<std::string, std::deque<RgbdFrame>> waiting_;  // by camera, in the order of their stamps
  std::map<std::string, double> newest_s_;                // by camera that has sent any
};

}  // namespace soft_robot_lab
