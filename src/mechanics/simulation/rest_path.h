// SPDX-License-Identifier: BSD-3-Clause
// The slow motion that leads from the present state to a rest state: of commands, obstacles, holds and loads, all in
// step with one another. A share of 0 is where it begins, 1 where it ends.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "simulation_parts.h"

namespace soft_robot_lab {

class RestPath {
 public:
  // From the state as it is. Its loads act at once.
  explicit RestPath(SimulationParts& parts);
  ~RestPath();  // with all loads as they are at the end
  RestPath(const RestPath&) = delete;
  RestPath& operator=(const RestPath&) = delete;

  void go_to(double share);
  // What is left of the forces where the path begins becomes a load that leaves on the way: so gravity comes slowly to
  // a body in its rest shape. False where it does already, and where nothing holds the body or an obstacle.
  bool bring_loads_slowly();
  bool loads_come_slowly() const { return left_n_.cols() > 0; }
  bool changes_commands() const { return commands_ != parts_.state.commands(); }
  bool changes_loads() const { return loads_come_slowly() || changes_commands(); }
  // Whether a part of the way changes less.
  bool changes_in_stages() const { return changes_loads() || something_moves(); }
  double time_s(double share) const { return share == 1.0 ? end_s_ : start_s_ + share * (end_s_ - start_s_); }
  // An obstacle or a hold.
  bool something_moves() const { return start_s_ != end_s_; }
  int poses_before(double share) const;  // how many poses of motions lie behind
  // How far what moves goes in a stage, an obstacle's centre or a held node at most.
  double largest_way_m(double from, double to) const;
  // The furthest share up to `to` that one stage from the present state at `from` may reach: up to the next pose of a
  // motion, no hold turns by more than 45 degrees, and no obstacle goes into the skin by more than half of itself or of
  // a face.
  double stage_end(double from, double to) const;

 private:
  SimulationParts& parts_;
  std::vector<double> commands_;
  double start_s_, end_s_;
  std::vector<double> poses_s_;  // times of poses, strictly between
  Eigen::Matrix3Xd left_n_;      // forces where it begins; empty where they leave at once
};

}  // namespace soft_robot_lab
