// SPDX-License-Identifier: BSD-3-Clause
// Obstacles that are too small or too sharp for the spacing of the contact points: skin goes into them where none is.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "contact_term.h"
#include "soft_robot_lab/mechanics/body.h"
#include "soft_robot_lab/mechanics/solve_report.h"

namespace soft_robot_lab {

// A warning `coarse_contact` for each obstacle that has gone into a face, between that face's contact points, by more
// than a twentieth of its half least extent. Its size is the depth [m].
// For each that is wholly in the silicone, so that no face meets it: its size is the distance to the skin's nearest
// node. And for each on which round skin of a body that nothing holds rubs over less than a face. Its size is that
// face's area over it [1].
std::vector<SolveWarning> coarse_contacts(const Body& body, const ContactTerm& contact,
                                          const Eigen::Matrix3Xd& positions_m, const ContactState& state);

// A warning of this kind: `why`, and how large elements should be there.
SolveWarning coarse_contact_warning(const Obstacle& obstacle, double size, const std::string& unit,
                                    const std::string& why, double element_size_m);

}  // namespace soft_robot_lab
