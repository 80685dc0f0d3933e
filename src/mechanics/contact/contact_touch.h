// SPDX-License-Identifier: BSD-3-Clause
// A contact point at a surface that it presses against, or nearly: an obstacle, or other skin.
#pragma once

#include <Eigen/Core>

#include "friction_law.h"
#include "skin_pairs.h"

namespace soft_robot_lab {

struct ContactTouch {
  int pair = 0;         // obstacle * points + point, and after all of these the points of the skin against itself
  bool closed = false;  // NormalLaw::closed
  double gap_m = 0.0, pressure_pa = 0.0;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  // Of an obstacle, the second derivative of the gap; of skin, its curvature.
  Eigen::Matrix3d bend = Eigen::Matrix3d::Zero();
  SkinPlace met;                                    // of skin
  int free = -1;                                    // the obstacle among the free; -1: it is not
  Eigen::Vector3d arm_m = Eigen::Vector3d::Zero();  // from that one's centre
  // Of friction; without any the limit is negative.
  FrictionLaw friction{0.0, -1.0};
  Eigen::Vector3d anchor_m = Eigen::Vector3d::Zero();     // where the obstacle, or the other skin, now has it
  Eigen::Vector3d anchored_at = Eigen::Vector3d::Zero();  // of skin: ContactState::anchors_m
  Eigen::Vector3d away_m = Eigen::Vector3d::Zero();       // from there, along the surface
  double above_m = 0.0;                                   // and square to it

  bool rubs() const { return friction.limit_pa >= 0.0; }
  bool on_skin() const { return met.face >= 0; }
  // Whether it slips on or sticks is decided by what comes next.
  bool at_limit() const { return closed && friction.limit_pa > 0.0 && friction.at_limit(away_m); }
  // How away_m changes where the point moves so from its anchor and the normal turns.
  Eigen::Vector3d along_surface(const Eigen::Vector3d& way_m, const Eigen::Vector3d& turn) const {
    return way_m - normal * (normal.dot(way_m) + turn.dot(away_m)) - turn * above_m;
  }
  void set_way_m(const Eigen::Vector3d& from_anchor_m) {
    above_m = normal.dot(from_anchor_m);
    away_m = from_anchor_m - normal * above_m;
  }
};

}  // namespace soft_robot_lab
