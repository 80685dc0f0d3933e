// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "mechanics/reduced/reduced_simulation.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {

// Moves a scene's simulation. With a reduced model that one moves in its place, until it is given a command that it was
// not trained for, or finds no way: then the simulation goes on from there, with a warning.
class SceneMotion {
 public:
  explicit SceneMotion(Scene& scene);

  void set_command(const std::string& actuator, double command);  // throws as Simulation does
  SolveReport step();
  SolveReport solve_equilibrium();

  bool reduced() const { return fast_.has_value(); }  // still
  double time_s() const;
  Eigen::Matrix3Xd markers_m() const;                                   // 3 x markers
  int inverted_elements() const { return fast_->inverted_elements(); }  // while reduced()

  void show();  // gives the simulation the present state

 private:
  // Nothing where there is no reduced model, or it failed and was left.
  std::optional<SolveReport> by_reduced(ReducedReport (ReducedSimulation::*move)(), const std::string& failure);
  void leave(const std::string& why);
  SolveReport finish(SolveReport report);  // with the warnings

  Simulation& simulation_;
  std::optional<ReducedSimulation> fast_;
  std::vector<SolveWarning> warnings_;
};

}  // namespace soft_robot_lab
