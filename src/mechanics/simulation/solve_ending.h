// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mechanics/contact/fast_obstacles.h"
#include "mechanics/newton/newton_solver.h"
#include "soft_robot_lab/mechanics/body.h"
#include "soft_robot_lab/mechanics/solve_report.h"

namespace soft_robot_lab {

// How a solve ended, with place and size of what is wrong.
void tell_end(const NewtonReport& newton, const Body& body, SolveReport& report);

// That nodes did not move by the laws of mechanics: inverted elements and those around them were laid out anew.
void tell_untangled(int elements, SolveReport& report);

// That an obstacle was too fast for a step of length h, which is cut into no more than `most` parts.
void report_fast_obstacle(const ObstacleCuts& cuts, double most, const Body& body, double h, SolveReport& report);

}  // namespace soft_robot_lab
