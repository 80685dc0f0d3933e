// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "guard.h"
#include "python_state.h"
#include "robot/scene/scene_motion.h"
#include "soft_robot_lab/robot/scene/run_scene.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {

// How Python loads a scene: by the package's own mesher, with its built-in actuators and a trained reduced model.
SceneOptions python_scene_options();

// Of the present state, also of a reduced model.
std::vector<ActuatorReading> shown_readings(SceneMotion& motion);

// A command for each named actuator.
using NamedCommands = std::vector<std::pair<std::string, double>>;

// Positions that arrays of Python look at. They stay where they are, also when nobody but an array keeps them.
struct ShownNodes {
  Eigen::Matrix3Xd positions_m;
};

// A scene that Python moves. What is called here may throw as Simulation does; a solve that Ctrl-C ends leaves the
// state as it was, and throws KeyboardInterrupt.
class PythonSimulation : public Guarded {
 public:
  explicit PythonSimulation(Scene scene);

  std::shared_ptr<PythonSimulation> clone();  // of the same model, in the same state
  void set(const NamedCommands& commands);    // all or none
  SolveReport step();
  SolveReport settle();
  void reset();
  PythonState state();
  void set_state(const PythonState& state);  // where it throws the state is as it was
  Eigen::Matrix3Xd markers_m();
  Eigen::MatrixXd sensitivities();
  double time_s();
  std::vector<DriveState> drives();
  bool reduced();
  std::vector<ActuatorReading> readings();
  std::vector<ContactReading> contacts();
  std::shared_ptr<const ShownNodes> nodes();  // brought up to date at every change while somebody keeps it

  // The scene's own run, from the rest shape, on a simulation of its own; `scene` is left as it ends.
  struct Run {
    RunReport report;
    std::string result_json;
  };
  Run run();

  // What never changes.
  const Scene& scene() const { return scene_; }
  const Model& model() const { return *scene_.simulation->model(); }

 private:
  Scene copy_of_scene();  // with a simulation of its own, in the rest shape
  SceneMotion& shown();   // after the full state is that of a reduced model too
  void keep_nodes_true();
  SolveReport moved(SolveReport (SceneMotion::*solve)());

  Scene scene_;
  std::unique_ptr<SceneMotion> motion_;
  std::shared_ptr<ShownNodes> nodes_;
};

}  // namespace soft_robot_lab
