// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "mechanics/contact/contact_term.h"
#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {

// The rigid motions of a body that neither its holds nor these touches resist, "moving along y and turning about x";
// empty where there is none. Axes of turning go anywhere along their direction.
std::string free_motion(const Body& body, const Eigen::Matrix3Xd& positions_m, const ContactSums& touching);

// The same of a free obstacle; skin and other obstacles count as held.
std::string free_motion(const ContactTerm& contact, int free, const ContactSums& touching);

}  // namespace soft_robot_lab
