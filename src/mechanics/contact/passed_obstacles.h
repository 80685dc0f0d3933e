// SPDX-License-Identifier: BSD-3-Clause
// Obstacles that are so small beside the faces of the skin that they may slip through between its contact points.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "contact_term.h"
#include "soft_robot_lab/mechanics/body.h"
#include "soft_robot_lab/mechanics/solve_report.h"

namespace soft_robot_lab {

// Whether there are any: with a half least extent of less than half of the largest face. Points that are so near to one
// another meet what is larger.
bool may_pass_obstacles(const Body& body, const ContactTerm& contact);

// A warning `coarse_contact` for each of them that a face took more than half way through itself, where its nodes go
// straight from one place to another beside the obstacle. Its size is the obstacle's half least extent [m].
std::vector<SolveWarning> passed_obstacles(const Body& body, const ContactTerm& contact, const Eigen::Matrix3Xd& from_m,
                                           const ContactState& from, const Eigen::Matrix3Xd& to_m,
                                           const ContactState& to);

}  // namespace soft_robot_lab
