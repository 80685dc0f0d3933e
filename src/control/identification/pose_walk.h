// SPDX-License-Identifier: BSD-3-Clause
// Goes from equilibrium to equilibrium, with what derivatives have to know of the past.
#pragma once

#include <vector>

#include "drive_play.h"
#include "pose_sensitivities.h"

namespace soft_robot_lab {

bool has_friction(const Simulation& simulation);

class PoseWalk {
 public:
  // Starts where the simulation is. `parameters` as in PoseModel; without `derivatives` they count for nothing.
  PoseWalk(Simulation& simulation, std::vector<ModelParameter> parameters, bool derivatives);

  // In one move, or where friction makes the way count by stages. Throws std::runtime_error where there is no rest.
  void go(const DriveEnds& end);

  const Eigen::MatrixXd& jacobian() const { return past_.sensitivities.jacobian(); }

  // To try several ways from one place.
  struct Past {
    std::vector<double> slopes;  // of the drives where they stand
    PoseSensitivities sensitivities;
  };
  const Past& past() const { return past_; }
  void go_back(const SimulationState& state, const Past& past);

 private:
  int solve(const std::vector<double>& from, const std::vector<double>& to, double fraction);
  void differentiate(const std::vector<double>& slopes);

  Simulation& simulation_;
  bool derivatives_, friction_;
  Past past_;
};

}  // namespace soft_robot_lab
