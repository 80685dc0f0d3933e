// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "soft_robot_lab/mechanics/body.h"
#include "soft_robot_lab/mechanics/solve_report.h"

namespace soft_robot_lab {

// `locking_elements`: linear elements of a material that hardly changes its volume are too stiff, so that every solver
// comes to a wrong shape without a word. The cantilever of 20 mm on elements of 10 mm sags by 62 % of the truth at 0.3,
// where nothing locks, by 56 % at 0.4, 49 % at 0.45 and 28 % at 0.49. Not for quadratic elements, nor for volumes
// averaged around vertices.
std::vector<SolveWarning> locking_warnings(const Body& body);

}  // namespace soft_robot_lab
