// SPDX-License-Identifier: BSD-3-Clause
// Free obstacles in a time step, by the same rule as the nodes: of centres and velocities, of turns since the step
// began and angular momenta. Momentum of either kind changes by what pushes, and by nothing else.
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "backward_difference.h"
#include "mechanics/body/free_obstacles.h"
#include "soft_robot_lab/mechanics/simulation_state.h"

namespace soft_robot_lab {

// What inertia refers to within one time step:  mass (c - predicted) per_s2, and the same of turns, with the inertia
// where the step is expected to end.
struct FreeInertia {
  double per_s2 = 0.0;
  FreePoses start;
  Eigen::Matrix3Xd predicted_m, predicted_rad;  // centres; turns since the start
  std::vector<Eigen::Matrix3d> kg_m2;
};

class FreeStep {
 public:
  FreeStep(const FreeObstacles& free, const SimulationState& before, const BackwardDifference& difference);

  const std::shared_ptr<const FreeInertia>& inertia() const { return inertia_; }  // null where nothing is free
  FreePoses predicted() const;                                                    // where the search starts
  FreeVelocities velocities(const FreePoses& end) const;
  FreeColumns inertia_n(const FreePoses& end) const;

 private:
  const FreeObstacles& free_;
  double gamma_s_;
  Eigen::Matrix3Xd centers_from_m_, turns_from_rad_;
  std::shared_ptr<const FreeInertia> inertia_;
};

double free_kinetic_j(const FreeObstacles& free, const FreePoses& at, const FreeVelocities& velocities);
FreeColumns free_way(const FreePoses& from, const FreePoses& to);
// The largest, of a centre or of the surface.
double free_speed_m_s(const FreeObstacles& free, const FreeVelocities& velocities);

}  // namespace soft_robot_lab
