// SPDX-License-Identifier: BSD-3-Clause
// Lines of threads, cut at the borders of elements.
#pragma once

#include <vector>

#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {

// Throws std::invalid_argument: Body::add_fibre. `index`: of the fibre among the body's.
std::vector<FibreGroup> fibre_groups(const TetMesh& mesh, const Fibre& fibre, int index);

}  // namespace soft_robot_lab
