// SPDX-License-Identifier: BSD-3-Clause
// What motions of the nodes change where skin meets skin. SkinContact::find_edges comes before.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "skin_contact.h"

namespace soft_robot_lab {

// A touch as a constraint C = -g of a Newton step, whose multiplier is the push w l: its gradient.
struct SkinGradient {
  int pair = 0, face = 0;  // ContactTouch::pair, and the face that it meets
  std::vector<int> nodes;
  Eigen::Matrix3Xd at_nodes;

  double dot(const double* columns) const;  // 3 a node
};

SkinGradient gradient_of(const SkinContact& skin, const ContactTouch& touch);

// How a motion of the nodes, by which point and place move so against each other, changes where they meet.
struct SkinPlaceMotion {
  Eigen::Vector2d local;  // coordinates on the face
  Eigen::Vector3d turn;   // of the normal
  double gap_m;
};
SkinPlaceMotion place_motion(const SkinContact& skin, const ContactTouch& touch, const Eigen::Vector3d& relative_m,
                             const Eigen::Matrix3Xd& motion_m);
// How it changes ContactTouch::away_m, and SkinContact::add_back of a force, whose place on the skin moves.
Eigen::Vector3d away_motion_m(const SkinContact& skin, const ContactTouch& touch, const Eigen::Vector3d& relative_m,
                              const Eigen::Matrix3Xd& motion_m);
void add_back_moved(const SkinContact& skin, const ContactTouch& touch, const Eigen::Vector3d& relative_m,
                    const Eigen::Matrix3Xd& motion_m, const Eigen::Vector3d& force_n, Eigen::Matrix3Xd& forces_n);

}  // namespace soft_robot_lab
