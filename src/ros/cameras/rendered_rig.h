// SPDX-License-Identifier: BSD-3-Clause
// The rendered cameras of a session: which frames are due, and what stands before the cameras.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "perception/render/camera_setup.h"
#include "seen_robot.h"

namespace soft_robot_lab {

struct TakenFrame {
  std::size_t camera = 0;
  ros::Time stamp;
  RgbdFrame frame;
};

struct FrameCounts {
  long taken = 0;
  long dropped = 0;  // due, but a later one was due too when there was time
  double cpu_s = 0;  // of all that were taken
};

class RenderedRig {
 public:
  // The seed makes the sensors' noise. Calibration balls are hidden. Throws std::domain_error where a lens folds.
  RenderedRig(CameraSetup rig, std::uint64_t seed);

  // The cameras where they stand now.
  const std::vector<RigCamera>& cameras() const { return rig_.cameras; }
  const FrameCounts& counts(std::size_t camera) const { return shooting_[camera].counts; }

  void show_balls(bool shown);
  // By metres in the world, and by a rotation vector [rad] in the world about where the camera stands then. Throws
  // std::invalid_argument: name, numbers that are not finite.
  const RigCamera& move(const std::string& name, const Eigen::Vector3d& translation_m,
                        const Eigen::Vector3d& rotation_rad);
  // Exposure and gain; automatic at first. Throws std::invalid_argument: out of range.
  const CameraSetting& setting(std::size_t camera) const { return shooting_[camera].setting; }
  void set(std::size_t camera, const CameraSetting& setting);

  // Of the newest moment, by those wanted cameras whose next frame is due: the first moment at or after a multiple of
  // 1 / rate_hz of session time.
  std::vector<TakenFrame> take_due(const SeenRobotStates& robot, const std::function<bool(std::size_t)>& wanted);

 private:
  struct Shooting {
    RenderedCamera camera;
    CameraSetting setting;
    FrameCounts counts;
    std::int64_t last_frame = -1;  // by its number since session time 0; -1: none since it is wanted
  };
  void build_stage(SeenRobot robot, const SeenState& state);
  RenderedCamera made(std::size_t camera, const CameraSetting& setting) const;
  void follow(const SeenRobotStates& robot, const SeenState& state);
  bool is_due(Shooting& shooting, std::int64_t frame);

  CameraSetup rig_;
  std::uint64_t seed_;
  bool balls_shown_ = false;
  int robot_version_ = 0;
  std::unique_ptr<RayScene> stage_;
  std::vector<Shooting> shooting_;  // as rig_.cameras
};

}  // namespace soft_robot_lab
