// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include "soft_robot_lab/perception/tracking/rgbd_frame.h"
#include "soft_robot_lab/perception/tracking/tracker.h"
#include "soft_robot_lab/perception/tracking/tracker_camera.h"

namespace soft_robot_lab {

struct UsableFrame {
  const RgbdFrame* frame;
  const TrackerCamera* camera;
};

// Decides which frames the tracker may use, by their form and their stamps.
class FrameGate {
 public:
  void set_camera(const TrackerCamera& camera);

  // Refused frames are left out, each with its reason in `problems`.
  std::vector<UsableFrame> pass(const std::vector<RgbdFrame>& frames, std::vector<CameraProblem>& problems);
  // Adds a problem for each camera whose last usable frame is older than this at `time_s`.
  void report_silence(double time_s, double timeout_s, std::vector<CameraProblem>& problems) const;
  int late_frames() const { return late_frames_; }
  void reset();

 private:
  struct Known {
    TrackerCamera camera;
    double last_stamp_s;
  };
  std::string refuse(const RgbdFrame& frame);  // why, or nothing

  std::map<std::string, Known> known_;
  int late_frames_ = 0;
};

}  // namespace soft_robot_lab
