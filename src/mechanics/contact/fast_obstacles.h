// SPDX-License-Identifier: BSD-3-Clause
// Obstacles that in one time step would go so far into the skin, or through it, that it gave way to the wrong side.
#pragma once

#include <Eigen/Core>

#include "contact_term.h"
#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {

// Into how many parts a step h is to be cut, at least 1. In one part no obstacle moves by more than half of itself, or
// of a face, against skin that it would go into; planes have no other side. By the velocities where the step starts.
double parts_for_obstacles(const Body& body, const ContactTerm& contact, const Eigen::Matrix3Xd& positions_m,
                           const Eigen::Matrix3Xd& velocities_m_s, const ContactState& state,
                           const FreeVelocities& free_velocities, double h);

}  // namespace soft_robot_lab
