// SPDX-License-Identifier: BSD-3-Clause
// The controller's own model of the robot, and its reduced model where the session has one. Whoever uses it holds its
// lock.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <visualization_msgs/Marker.h>

#include "robot/scene/reduction.h"
#include "robot/scene/scene_motion.h"
#include "ros/display/surface_marker.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {

class ControllerModel {
 public:
  using Lock = std::unique_lock<std::mutex>;

  Lock lock() { return Lock(mutex_); }
  Lock try_lock() { return Lock(mutex_, std::try_to_lock); }
  // Throws std::runtime_error where another request uses the model.
  Lock lock_or_refuse();

  void take(Scene scene);
  bool is_there() const { return simulation_ != nullptr; }
  const ReducedChoice* reduced() const { return motion_->reduction() ? &motion_->reduction()->choice : nullptr; }
  void leave_reduced();

  Simulation& simulation() { return *simulation_; }
  // For a search: it goes elsewhere than the robot.
  Simulation& to_search() {
    searched_ = true;
    return *simulation_;
  }
  // Rests where these commands lead: after a search by way of the rest shape, else from where it followed the robot
  // before. False where it finds no rest state there.
  bool follow(const std::map<std::string, double>& commands);

  std::vector<Eigen::Vector3d> markers_m() const;
  visualization_msgs::Marker skin();

 private:
  std::mutex mutex_;
  std::unique_ptr<Simulation> simulation_;
  std::optional<SceneMotion> motion_;  // for rest states that the robot is followed to
  std::unique_ptr<SurfaceMarker> surface_;
  bool searched_ = false;  // it was elsewhere than the robot since it last followed it
};

}  // namespace soft_robot_lab
