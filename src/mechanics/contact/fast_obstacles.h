// SPDX-License-Identifier: BSD-3-Clause
// Obstacles that in one time step would go so far into the skin, or through it, that it gave way to the wrong side.
#pragma once

#include <Eigen/Core>

#include "contact_term.h"
#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {

// What asks most that a step be cut.
struct ObstacleCuts {
  double parts = 1.0;  // [1, inf]: into how many
  double way_m = 0.0;  // of the obstacle in the step, against what it would go into
  int obstacle = -1;   // among Body::obstacles; -1: none
};

// Into how many parts a step h is to be cut. In one part no obstacle moves by more than half of itself, or of a face,
// against skin that it would go into, and no free one by half of the lesser against another obstacle that it would
// meet; planes have no other side. By the velocities where the step starts. Motion that is not finite asks for endless
// parts.
ObstacleCuts parts_for_obstacles(const Body& body, const ContactTerm& contact, const Eigen::Matrix3Xd& positions_m,
                                 const Eigen::Matrix3Xd& velocities_m_s, const ContactState& state,
                                 const FreeVelocities& free_velocities, double h);

}  // namespace soft_robot_lab
