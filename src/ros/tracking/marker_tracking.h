// SPDX-License-Identifier: BSD-3-Clause
// The tracker behind messages, of a session and of a recording alike.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <ros/time.h>
#include <sensor_msgs/CameraInfo.h>
#include <soft_robot_lab/TrackerUpdateLog.h>

#include "ros/messages/messages.h"
#include "perception/calibration/camera_pose.h"
#include "perception/calibration/extrinsics_monitor.h"
#include "perception/tracking/frame_joiner.h"
#include "soft_robot_lab/perception/tracking/tracker.h"

namespace soft_robot_lab {

struct TrackingOptions {
  std::vector<std::string> cameras;  // by the first part of their topics; at least one
  double sync_tolerance_s = 0.016;   // frames within it are one moment: half a frame at 30 Hz
  double sync_timeout_s = 0.1;       // waited for a camera's frame, by the others' stamps
  // Where a simulation has the markers is asked for so long before a frame, that its message has come for certain: so
  // the answer does not depend on who was faster.
  double simulated_before_s = 0.05;
  void validate() const;  // throws std::invalid_argument: field, value, allowed range
};

class MarkerTracking {
 public:
  struct Result {
    TrackerReport report;
    MarkerObservations observations;  // frame_id: robot_base; only where report.updated
    TrackerUpdateLog step;            // what they were made from; only where report.updated
    std::vector<RgbdFrame> frames;
  };

  MarkerTracking(const TrackingOptions& options, const TrackerSettings& settings,
                 const std::vector<TrackedMarker>& markers);

  void set_poses(const std::vector<CameraPose>& poses);
  // From the next frame on; what it remembers of frames so far stays.
  void set_settings(const TrackerSettings& settings);
  void add_info(const std::string& camera, const sensor_msgs::CameraInfo& info);
  void add_simulated(const MarkerObservations& message);
  // What came of frames that are complete now. Frames of a camera whose pose or lens is not known yet are left out and
  // counted. A frame that is more than a second older than the camera's newest shows that the clock was set back.
  std::vector<Result> add(const RgbdFrame& frame);
  std::vector<Result> finish();
  void reset();  // for a clock that goes back

  // Does a recorded step of the same markers again, with its frames, poses and camera_infos. Where it follows the last
  // one, this goes on from its own state, else from the recorded one. Throws std::invalid_argument for lists of wrong
  // lengths.
  Result repeat(const TrackerUpdateLog& step, std::vector<RgbdFrame> frames);
  bool follows(const TrackerUpdateLog& step) const { return step.number == next_step_; }

  const std::map<std::string, TrackerCamera>& cameras() const { return ready_; }
  const std::vector<TrackedMarker>& markers() const { return markers_; }
  const ExtrinsicsMonitor& watch() const { return watch_; }
  long unusable_frames() const { return unusable_frames_; }

 private:
  std::vector<Result> track(std::vector<std::vector<RgbdFrame>> groups);
  Result update(std::vector<RgbdFrame> group, const std::vector<Eigen::Vector3d>& simulated_m);
  void describe(const std::vector<RgbdFrame>& group, const std::vector<std::string>& used, TrackerUpdateLog& step);
  std::vector<Eigen::Vector3d> simulated_before(double stamp_s);
  void introduce(const std::string& camera);
  void follow_clock(const RgbdFrame& frame);

  struct Simulated {
    double stamp_s;
    std::vector<Eigen::Vector3d> positions_m;  // in the order of the markers
  };

  TrackingOptions options_;
  std::vector<TrackedMarker> markers_;
  Tracker tracker_;
  FrameJoiner joiner_;
  ExtrinsicsMonitor watch_{{}};
  std::map<std::string, Eigen::Isometry3d> poses_;
  std::map<std::string, sensor_msgs::CameraInfo> infos_;
  std::map<std::string, TrackerCamera> ready_;  // both known
  std::deque<Simulated> simulated_;
  std::map<std::string, double> newest_s_;  // frame of each camera
  std::uint32_t next_step_ = 0;
  long unusable_frames_ = 0;
};

}  // namespace soft_robot_lab
