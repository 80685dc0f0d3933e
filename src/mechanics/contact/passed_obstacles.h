// SPDX-License-Identifier: BSD-3-Clause
// Obstacles that skin goes through: between its contact points, or where a step is longer than they are large.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "contact_term.h"
#include "soft_robot_lab/mechanics/body.h"
#include "soft_robot_lab/mechanics/solve_report.h"

namespace soft_robot_lab {

// Which obstacles are looked at.
enum class PassedSizes {
  small,  // of a half least extent of less than half of a face: points of larger faces may all miss them
  any
};

// Whether there are small ones.
bool has_small_obstacles(const Body& body, const ContactTerm& contact);

// Where a body is, and what it meets there.
struct BodyPlace {
  const Eigen::Matrix3Xd& positions_m;
  const ContactState& contact;
};

// A warning `coarse_contact` for each of them that a face took more than half way through itself, where its nodes go
// straight from one place to another beside the obstacle. Its size is the obstacle's half least extent [m].
std::vector<SolveWarning> passed_obstacles(const Body& body, const ContactTerm& contact, const BodyPlace& from,
                                           const BodyPlace& to, PassedSizes sizes);

}  // namespace soft_robot_lab
