// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "mechanics/contact/fast_obstacles.h"
#include "mechanics/contact/rigid_overlap.h"
#include "mechanics/newton/newton_solver.h"
#include "soft_robot_lab/mechanics/body.h"
#include "soft_robot_lab/mechanics/solve_report.h"

namespace soft_robot_lab {

// How a solve ended, with place and size of what is wrong.
void report_end(const NewtonReport& newton, const Body& body, SolveReport& report);

// That nodes did not move by the laws of mechanics: inverted elements and those around them were laid out anew.
void report_untangled(int elements, SolveReport& report);

inline constexpr double kLeastSnap = 0.01;  // of the body's size: a shorter way leads on, not away

// A loss of stability on the way to a rest state.
struct Snap {
  double share = 0.0;  // of the way, where it was lost
  double moved_m = 0.0;
  Eigen::Vector3d rest_position_m = Eigen::Vector3d::Zero();  // of the node that moved so far
  bool other_side = false;                                    // is as easy
};

// Between the positions before and after it, 3 x nodes.
Snap snap_between(const Eigen::Matrix3Xd& before_m, const Eigen::Matrix3Xd& after_m, double share, bool other_side,
                  const Body& body);
void note_snap(const Snap& snap, SolveReport& report);

// That rigid things are in one another: no such state is a solution. `help`: what to do.
void report_overlap(const RigidOverlap& overlap, const Body& body, const std::string& help, SolveReport& report);

// That an obstacle was too fast for a step of length h, which is cut into no more than `most` parts.
void report_fast_obstacle(const ObstacleCuts& cuts, double most, const Body& body, double h, SolveReport& report);

}  // namespace soft_robot_lab
