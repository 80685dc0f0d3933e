// SPDX-License-Identifier: BSD-3-Clause
// Obstacles that a motion of the nodes would carry skin into so far, or through, that it gave way to the wrong side.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "contact_term.h"
#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {

// How deep a contact point may go into an obstacle on one step of a solver: half of the obstacle's half least extent,
// or half of the size of the point's face. Infinite for planes, which have no other side.
double allowed_depth_m(const Obstacle& obstacle, double face_size_m);

// The part of a straight way on which a point first is deeper than `depth_m` in an obstacle that stands still, or as
// near to that as `near_m`. By conservative advancement: a distance changes no faster than the point moves (Mirtich
// 1996). A depth below zero is a distance.
double part_until(const ObstacleShape& shape, const Eigen::Isometry3d& pose, const Eigen::Vector3d& from_m,
                  const Eigen::Vector3d& way_m, double depth_m, double near_m);

// The part in (0, 1] of a motion of the nodes up to which no contact point goes deeper into
// an obstacle than allowed_depth_m, or than it is where the motion begins. Free obstacles give way, and are left out.
double part_before_obstacles(const Body& body, const ContactTerm& contact, const Eigen::Matrix3Xd& positions_m,
                             const Eigen::Matrix3Xd& motion_m, const ContactState& state);

// The same, and so short that skin goes no deeper into skin than SkinContact::first_length allows.
double part_before_contact(const Body& body, const ContactTerm& contact, const Eigen::Matrix3Xd& positions_m,
                           const Eigen::Matrix3Xd& motion_m, const ContactState& state);

}  // namespace soft_robot_lab
