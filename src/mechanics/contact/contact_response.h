// SPDX-License-Identifier: BSD-3-Clause
// What derivatives of a state with contact need besides the matrix, and what friction dissipates.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "contact_term.h"

namespace soft_robot_lab {

// What stands at the limit of friction: points of the skin, and after these obstacles among themselves.
struct TouchesAtLimit {
  std::vector<ContactTouch> points;
  RigidTouches rigid;

  Eigen::Index count() const { return static_cast<Eigen::Index>(points.size() + rigid.size()); }
};

// What the residual gains where one of them slips by a metre; and by how much a motion takes the tie of each beyond its
// limit, which follows the pressure, as a way of slip.
void add_slip(const ContactTerm& contact, const TouchesAtLimit& all, Eigen::Index one, Eigen::Matrix3Xd& residual_n,
              FreeColumns& free_n);
Eigen::VectorXd beyond_limits_m(const ContactTerm& contact, const TouchesAtLimit& all, const Eigen::Matrix3Xd& motion_m,
                                const FreeColumns& free_motion);
Eigen::VectorXd limits_n(const ContactTerm& contact, const TouchesAtLimit& all);

// Ties turn with a surface that is not flat, or that moves, and obstacles roll: what the matrix, which is symmetric,
// lacks.
bool any_turns(const std::vector<ContactTouch>& touches, const RigidTouches& rigid);
void add_turned_ties(const ContactTerm& contact, const std::vector<ContactTouch>& touches, const RigidTouches& rigid,
                     const Eigen::Matrix3Xd& motion_m, const FreeColumns& free_motion, Eigen::Matrix3Xd& residual_n,
                     FreeColumns& free_n);

// What friction dissipates where the anchors follow what slipped, by ContactTerm::commit.
double rubbed_j(const ContactTerm& contact, const ContactSums& at);

}  // namespace soft_robot_lab
