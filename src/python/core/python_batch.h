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

// Many worlds of one scene, or of several that differ in numbers, moved by several threads. They share models and
// nothing that changes, so their numbers are those of one thread to the last bit. Where Ctrl-C ends a call each world
// stands before its last solve or after it.
class PythonBatch : public Guarded {
 public:
  // World i begins as scene i modulo their number. Throws std::invalid_argument for a number out of range, and where
  // scenes differ in actuators, markers or time steps.
  PythonBatch(std::vector<Scene> scenes, int worlds, int threads);

  int worlds() const { return static_cast<int>(worlds_.size()); }
  int threads() const { return threads_; }
  const Model& model() const { return *scenes_.front().simulation->model(); }  // the first

  // worlds x actuators, all or none. Throws std::invalid_argument naming the world.
  void set(const Eigen::MatrixXd& commands);
  std::vector<SolveReport> step(int steps);                     // >= 1; of each world its reports in one
  std::vector<SolveReport> settle(const std::vector<int>& of);  // of these worlds
  // `scenes`: of which each of them is from now on; empty: as before. All or none.
  void reset(const std::vector<int>& of, const std::vector<int>& scenes);
  PythonState state(int world);
  void set_state(int world, const PythonState& state);

  std::vector<int> scene_numbers();                     // of each world
  Eigen::MatrixXd commands(double DriveState::*which);  // worlds x actuators
  std::vector<Eigen::Matrix3Xd> markers_m();
  std::vector<double> time_s();
  std::vector<Eigen::MatrixXd> sensitivities();
  std::vector<ActuatorReading> readings(int world);
  std::vector<ContactReading> contacts(int world);

 private:
  struct World {
    int scene = -1;
    std::unique_ptr<Simulation> simulation;
    std::unique_ptr<SceneMotion> motion;
  };
  void become(World& world, int scene);
  // In all threads; throws what the first of the worlds threw.
  void each(const std::function<void(std::size_t)>& work);
  SceneMotion& at(int world);

  std::vector<Scene> scenes_;
  int threads_;
  std::vector<World> worlds_;
};

}  // namespace soft_robot_lab
