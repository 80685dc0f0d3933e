// SPDX-License-Identifier: BSD-3-Clause
// Free obstacles in the substeps of xpbd: rigid bodies that inertia carries, and that contact moves by positions
// (Mueller, Macklin, Chentanez, Jeschke & Kim 2020). Their inertia is that of a time step (FreeStep), so what nothing
// touches keeps its angular momentum.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "mechanics/body/free_obstacles.h"
#include "mechanics/state/free_stepping.h"
#include "soft_robot_lab/mechanics/obstacle.h"

namespace soft_robot_lab {

class FreeSweep {
 public:
  // `free` outlives this.
  explicit FreeSweep(const FreeObstacles& free) : free_(free) {}

  // Where a substep of length h begins: the way by inertia and by gravity.
  void begin(double h, const FreePoses& poses, const FreeVelocities& velocities);

  // By a force, at an arm from the obstacle's centre; and what a unit of it does there in a unit of time, squared.
  void push(int free, const Eigen::Vector3d& arm_m, const Eigen::Vector3d& force_n);
  Eigen::Matrix3d inverse_mass_per_kg(int free, const Eigen::Vector3d& arm_m) const;
  Eigen::Vector3d way_m(int free, const Eigen::Vector3d& arm_m) const;  // since place()

  FreePoses place();                                      // at the end of the way
  FreeVelocities velocities(const FreePoses& end) const;  // where the substep ends
  std::shared_ptr<const FreeInertia> inertia() const { return step_ ? step_->inertia() : nullptr; }

 private:
  const FreeObstacles& free_;
  double h_ = 0.0;
  std::optional<FreeStep> step_;
  std::vector<Eigen::Matrix3d> inverse_inertias_;
  FreePoses poses_;  // where way_ begins
  FreeColumns way_;
};

}  // namespace soft_robot_lab
