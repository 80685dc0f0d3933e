// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "pulled_motion.h"
#include "perception/render/camera_setup.h"
#include "soft_robot_lab/perception/tracking/tracker.h"

namespace soft_robot_lab {

// How well a film was tracked. A marker-frame is one marker in one frame of the film.
struct TrackingScore {
  int frames = 0;
  int marker_frames = 0;
  int seen = 0;                 // marker-frames that the tracker says it saw
  int visible = 0;              // of which at least one camera sees the sticker's middle and half its area
  int hidden_from_one = 0;      // visible, but not to all cameras
  int missed = 0;               // visible, and not seen
  int wrong = 0;                // seen, and more than 5 mm off
  int swaps = 0;                // seen, and nearer to another marker's true position than to its own
  double squared_error_m2 = 0;  // summed over the seen
  double worst_error_m = 0;     // of the seen
  double interpolated_squared_error_m2 = 0;
  int interpolated = 0;
  double cpu_s = 0;               // of the tracker
  std::vector<double> latency_s;  // CPU time of each update
  std::vector<double> marker_squared_error_m2;
  std::vector<int> marker_seen;

  double rms_m() const;
  double interpolated_rms_m() const;
  double missed_ratio() const;
  double false_ratio() const;
  double cpu_cores(double rate_hz) const;  // CPU-seconds a second of film
};

std::vector<TrackedMarker> tracked_markers(const Simulation& simulation);

// Films the moments of the simulation and tracks them; `progress` gets the share done.
TrackingScore track(const std::vector<Moment>& moments, const Simulation& simulation, const CameraSetup& rig,
                    const TrackerSettings& settings, const std::function<void(double)>& progress);

}  // namespace soft_robot_lab
