// SPDX-License-Identifier: BSD-3-Clause
// Derivatives of a walk's equilibria, also by the backlash of drives.
#pragma once

#include <utility>
#include <vector>

#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

class PoseSensitivities {
 public:
  explicit PoseSensitivities(std::vector<ModelParameter> parameters);

  // At the simulation's present equilibrium, one of all on the way; `slopes` as DriveEnds::slopes.
  void update(Simulation& simulation, const std::vector<double>& slopes);
  void forget();  // without friction the way does not matter

  // d marker / d parameter, 3*markers x parameters; empty before the first update.
  const Eigen::MatrixXd& jacobian() const { return jacobian_; }

 private:
  struct Backlash {
    Eigen::Index column, offset;  // the latter of a length offset without a past
    std::size_t actuator;
  };

  Eigen::Index count_;
  std::vector<ModelParameter> parameters_;
  std::vector<Backlash> backlashes_;
  Eigen::MatrixXd slipped_m_, jacobian_;
};

}  // namespace soft_robot_lab
