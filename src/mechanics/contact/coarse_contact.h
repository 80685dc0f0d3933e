// SPDX-License-Identifier: BSD-3-Clause
// Obstacles that are smaller than the spacing of the contact points: skin may go into them where no point is.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "contact_term.h"
#include "soft_robot_lab/mechanics/body.h"
#include "soft_robot_lab/mechanics/solve_report.h"

namespace soft_robot_lab {

// A warning `coarse_contact` for each obstacle whose half least extent is below half the size of a face that it has
// gone into, between that face's contact points, by more than a twentieth of that extent. Its size is the depth [m].
// And for each on which round skin of a body that nothing holds rubs over less than a face. Its size is that face's
// area over it [1].
std::vector<SolveWarning> coarse_contacts(const Body& body, const ContactTerm& contact,
                                          const Eigen::Matrix3Xd& positions_m, const ContactState& state);

}  // namespace soft_robot_lab
