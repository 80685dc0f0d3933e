// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "soft_robot_lab/mechanics/body.h"
#include "soft_robot_lab/mechanics/marker.h"
#include "soft_robot_lab/mechanics/solve_report.h"

namespace soft_robot_lab {

// What cannot move, whatever is commanded, because the boxes in `fixed` hold it: all there is (`nothing_moves`), or a
// marker (`held_marker`) or a fibre (`held_fibre`). None where a held region moves, or all that is held carries
// obstacles.
std::vector<SolveWarning> still_parts(const Body& body, const MeshLocator& locator, const std::vector<Marker>& markers);

}  // namespace soft_robot_lab
