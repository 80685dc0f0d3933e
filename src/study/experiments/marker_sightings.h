// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "session/report/frame_recorder.h"
#include "soft_robot_lab/perception/tracking/tracker_settings.h"

namespace soft_robot_lab {

// A marker in an image that shows its middle.
struct MarkerDetectioning {
  std::size_t marker = 0;
  Eigen::Vector2d true_px = Eigen::Vector2d::Zero();
  std::optional<Eigen::Vector2d> found_px;  // the nearest blob's centre, where one is within the sticker's radius
};

struct MarkerSightings {
  int images = 0;
  int complete_states = 0;  // in which each marker was found by a camera
  int strays = 0;           // blobs that are within no sticker's radius
  std::vector<MarkerDetectioning> sightings;
};

// Distances of blobs from the true places of one marker, or of all.
struct SightingScore {
  int in_sight = 0, found = 0;
  double mean_px = 0, deviation_px = 0;

  double ratio() const { return in_sight ? double(found) / in_sight : 0; }
};

// Every camera of the rig films the robot at rest in each state, and the markers are sought in the whole image.
MarkerSightings sight_markers(const std::vector<SimulationState>& states, const Simulation& simulation,
                              const CameraSetup& rig, const DetectorSettings& settings,
                              const std::function<void(double fraction)>& progress);

SightingScore score(const MarkerSightings& sightings, std::optional<std::size_t> marker = {});

}  // namespace soft_robot_lab
