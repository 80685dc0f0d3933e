// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "guard.h"
#include "python_state.h"
#include "robot/scene/scene_motion.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {

// Many worlds of one scene, moved by several threads. They share the model and nothing that changes, so their numbers
// are those of one thread to the last bit. Where Ctrl-C ends a call each world stands before its last solve or after
// it.
class PythonBatch : public Guarded {
 public:
  // Throws std::invalid_argument for a number out of range.
  PythonBatch(Scene scene, int worlds, int threads);

  int worlds() const { return static_cast<int>(worlds_.size()); }
  int threads() const { return threads_; }
  const Scene& scene() const { return scene_; }
  const Model& model() const { return *scene_.simulation->model(); }

  // worlds x actuators, all or none. Throws std::invalid_argument naming the world.
  void set(const Eigen::MatrixXd& commands);
  std::vector<SolveReport> step(int steps);  // >= 1; of each world its reports in one
  std::vector<SolveReport> settle();
  void reset(const std::vector<int>& of);
  PythonState state(int world);
  void set_state(int world, const PythonState& state);

  Eigen::MatrixXd commands(double DriveState::*which);  // worlds x actuators
  std::vector<Eigen::Matrix3Xd> markers_m();
  std::vector<double> time_s();
  std::vector<Eigen::MatrixXd> sensitivities();

 private:
  struct World {
    std::unique_ptr<Simulation> simulation;
    std::unique_ptr<SceneMotion> motion;
  };
  // In all threads; throws what the first of the worlds threw.
  void each(const std::function<void(std::size_t)>& work);
  SceneMotion& at(int world);

  Scene scene_;
  int threads_;
  std::vector<World> worlds_;
};

}  // namespace soft_robot_lab
