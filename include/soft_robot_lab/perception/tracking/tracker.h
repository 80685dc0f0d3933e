// SPDX-License-Identifier: BSD-3-Clause
// From colour and depth images to named markers, in the frame that the cameras' poses are given in.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "camera_observation.h"
#include "rgbd_frame.h"
#include "tracker_camera.h"
#include "tracker_settings.h"

namespace soft_robot_lab {

struct TrackedMarker {
  std::string name;
  Eigen::Vector3d rest_position_m = Eigen::Vector3d::Zero();
};

enum class MarkerSource { seen, interpolated };

// As in msg/MarkerObservations.msg.
struct MarkerObservation {
  std::string name;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();
  MarkerSource source = MarkerSource::seen;
  int cameras = 0;  // that saw it
};

struct CameraProblem {
  std::string camera, message;  // the message names the camera too
  bool silent = false;          // nothing usable came for long; else a frame was left out
};

struct TrackerReport {
  double stamp_s = 0;
  bool updated = false;                    // else no frame could be used, and all below is as it was before
  std::vector<MarkerObservation> markers;  // in the order they were given in, without the lost ones
  std::vector<std::string> lost;           // not seen for MotionSettings::lost_after_s, or never
  std::vector<std::string> cameras;        // whose frames were used, in their order
  std::vector<CameraProblem> problems;     // frames refused and silent cameras, each with its reason
  std::vector<CameraObservation> sights;   // markers as single cameras measured them, for ExtrinsicsMonitor
  int late_frames = 0;                     // refused so far because newer ones had come before
};

class Tracker {
 public:
  // Throws std::invalid_argument: no markers, names that are alike, positions that are not finite, colours of markers
  // that there are not.
  Tracker(const TrackerSettings& settings, const std::vector<TrackedMarker>& markers);
  ~Tracker();
  Tracker(Tracker&&) noexcept;
  Tracker& operator=(Tracker&&) noexcept;

  // A new camera, or a known one with a new pose. Throws std::invalid_argument for what is no camera or no pose.
  void set_camera(const TrackerCamera& camera);

  // Where a simulation has the markers now, all of them in their order; from then on they stand in for the rest
  // positions where a marker is looked for first, and in the motion of hidden ones. Throws std::invalid_argument.
  void set_simulated(const std::vector<Eigen::Vector3d>& positions_m);

  // At most one frame of each camera, of about one time. Frames that cannot be used are reported and left out.
  TrackerReport update(const std::vector<RgbdFrame>& frames);

  // Forgets what was seen, not the cameras: for a clock that goes back.
  void reset();

  // What it remembers of frames so far. A tracker of the same markers, cameras and settings that is given it goes on as
  // this one does, to the last digit; of its own it remembers nothing then. Throws std::invalid_argument for what is no
  // state of as many markers.
  std::vector<double> state() const;
  void set_state(const std::vector<double>& state);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace soft_robot_lab
