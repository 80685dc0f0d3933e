// A simulated robot before rendered cameras.
#pragma once

#include <string>
#include <vector>

#include "soft_robot_lab/render/camera_rig.h"
#include "soft_robot_lab/render/rendered_camera.h"
#include "soft_robot_lab/sim/simulation.h"
#include "soft_robot_lab/vision/tracker.h"

namespace soft_robot_lab {

struct FilmMoment {
  double time_s = 0;
  SeenMotion motion;  // its present stickers are the markers' true positions
};

struct CablePull {
  double left = 1, right = 1;  // contractions
};

SeenRobot seen_robot(const Simulation& simulation, const CameraRig& rig);
SeenState seen_state(const Simulation& simulation);

// Gives each pull in its turn to the first two actuators, from rest under gravity, and shows the robot at `rate_hz`
// as it moves: steps of the simulation are 1 / (2 rate_hz) long. Throws std::runtime_error where the rest state
// cannot be found.
std::vector<FilmMoment> move_through(Simulation& simulation, const std::vector<CablePull>& pulls, double hold_s,
                                     double rate_hz);

// The same moments filmed by the rig's cameras, one after the other.
class FilmCrew {
 public:
  FilmCrew(const CameraRig& rig, const SeenRobot& robot, const SeenState& rest, std::uint64_t seed);
  std::vector<RgbdFrame> take(const FilmMoment& moment);
  const Stage& stage() const { return stage_; }

 private:
  Stage stage_;
  std::vector<RenderedCamera> cameras_;
  std::uint64_t frame_ = 0;
};

std::vector<TrackerCamera> tracker_cameras(const CameraRig& rig);
std::vector<TrackedMarker> tracked_markers(const Simulation& simulation);

}  // namespace soft_robot_lab
