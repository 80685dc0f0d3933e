// SPDX-License-Identifier: BSD-3-Clause
// A calibration as it is done: film, bring the balls, film again.
#pragma once

#include <deque>
#include <map>
#include <string>
#include <vector>

#include "calibration.h"
#include "soft_robot_lab/perception/tracking/tracker_camera.h"

namespace soft_robot_lab {

class CalibrationSession {
 public:
  // `frame_count` pictures of each camera are averaged. Throws std::invalid_argument: settings, no frames.
  CalibrationSession(const BallPlacement& placement, const BallFinderSettings& finder, int frame_count = 5);

  // A new camera, or a known one whose lens is known now. Its pose is not looked at.
  void set_camera(const TrackerCamera& camera);
  // Keeps the latest pictures of each camera; they must own their pixels. Those of unknown cameras are left out.
  void add(const RgbdFrame& frame);

  // The latest pictures are those without balls. Throws CalibrationError: a camera that has not sent enough.
  void remember_without_balls();
  // The latest pictures are those with balls, each camera's pose follows from its own. Throws CalibrationError: what
  // calibrate_by_balls() refuses, with what else came into the camera's sight; no pictures without balls; too few.
  std::vector<CameraCalibration> calibrate() const;

 private:
  struct Series {
    TrackerCamera camera;
    std::deque<RgbdFrame> latest;
    std::vector<RgbdFrame> without_balls;
  };
  void require_pictures() const;
  CameraCalibration calibrate(const Series& series) const;

  BallPlacement placement_;
  BallFinderSettings finder_;
  std::size_t frame_count_;
  std::map<std::string, Series> series_;
};

}  // namespace soft_robot_lab
