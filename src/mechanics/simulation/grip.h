// SPDX-License-Identifier: BSD-3-Clause
// Free obstacles that rub on a body whose holds all move alike from one time to another.
//
// What friction holds goes along. A rest state of so long a way has another solution too: the body slips past what it
// holds, which stays behind. Only the way in short parts says which of the two comes.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "simulation_parts.h"

namespace soft_robot_lab {

class Grip {
 public:
  // Of the present state, which stands at the first of these times.
  Grip(const SimulationParts& parts, double from_s, double to_s);

  bool holds_something() const { return !gripped_.empty(); }
  // Whether the holds go so little that what is gripped cannot be left behind.
  bool goes_a_short_way() const;
  // That state's body, and what it holds, by the way of its holds.
  void carry(SimulationState& state) const;
  // Whether all that was gripped went along to there, more than it stayed.
  bool took_along(const FreePoses& to) const;

 private:
  Eigen::Vector3d way_m(int free) const;

  const FreeObstacles& free_;
  FreePoses start_;
  std::optional<Eigen::Isometry3d> way_;
  std::vector<int> gripped_;  // among the free
};

}  // namespace soft_robot_lab
