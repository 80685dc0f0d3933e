// SPDX-License-Identifier: BSD-3-Clause
// A running simulation as the cameras of a rig film it, with the truth beside it. The world is robot_base.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "skin.h"
#include "perception/render/camera_setup.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

struct FrameRecorderOptions {
  std::optional<SensorModel> sensor;  // of all cameras, instead of the rig's: SensorModel{} is exact
  std::uint64_t seed = 1;
};

// Of a marker, as a camera truly sees it.
struct MarkerView {
  bool centre_seen = false;  // in the image, and nothing hides it
  double share_seen = 0;     // of its sticker's area
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double depth_m = 0;  // along the camera's z; <= 0 behind the camera, where `pixel` means nothing
};

struct Capture {
  std::vector<RgbdFrame> frames;               // a camera each, in the rig's order
  Eigen::Matrix3Xd markers_m;                  // true positions, a column a marker in the simulation's order
  std::vector<std::vector<MarkerView>> views;  // views[camera][marker]
};

class FrameRecorder {
 public:
  // Keeps a reference to the simulation, for its markers. Its mesh in its rest shape gives the look of the robot.
  FrameRecorder(const Simulation& simulation, const CameraSetup& rig, const FrameRecorderOptions& options = {});

  // What the cameras see of `present`, the robot moving as from `previous` to it in the time between the two; at rest
  // where they are of one time. Each call is one frame of every camera. Throws std::invalid_argument where a state is
  // not of this simulation's size or not finite, or time goes back.
  Capture take(const SimulationState& previous, const SimulationState& present, double stamp_s);

  const std::vector<RenderedCamera>& cameras() const { return cameras_; }

 private:
  SeenState seen(const Eigen::Matrix3Xd& positions_m) const;
  MarkerView view(int marker, const ExactCamera& camera) const;

  const Simulation& simulation_;
  Skin skin_;
  RayScene stage_;
  std::vector<RenderedCamera> cameras_;
  std::uint64_t frame_ = 0;
};

}  // namespace soft_robot_lab
