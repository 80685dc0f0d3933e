// SPDX-License-Identifier: BSD-3-Clause
// Sets of elements that share no node, so that one after another or at once makes no difference.
#pragma once

#include <vector>

#include "soft_robot_lab/mechanics/tet_mesh.h"

namespace soft_robot_lab {

// Each element's index, once, in the set of its colour. Greedy in the mesh's order: an element joins the emptiest
// colour that has none of its nodes yet, which keeps the sets alike in size. The same mesh gives the same colours.
std::vector<std::vector<int>> colour_elements(const TetMesh& mesh);

}  // namespace soft_robot_lab
