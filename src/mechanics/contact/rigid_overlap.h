// SPDX-License-Identifier: BSD-3-Clause
// Rigid things that are in one another: what contact has to keep apart, looked at after each solve.
#pragma once

#include <string>

#include "contact_term.h"
#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {

// Of two obstacles of which one is free.
struct RigidOverlap {
  double depth_m = 0.0, allowed_m = 0.0;
  int one = -1, other = -1;  // among Body::obstacles

  bool found() const { return one >= 0; }
};

// The one that is deepest against what is allowed (rigid_depth.h).
RigidOverlap overlap_at(const Body& body, const ContactTerm& contact, const ContactState& state);

// Also on the straight way from where the step that led to this state began. None where two were in one another there.
RigidOverlap overlap_on_way(const Body& body, const ContactTerm& contact, const ContactState& state);

std::string text_of(const RigidOverlap& overlap, const Body& body);

}  // namespace soft_robot_lab
