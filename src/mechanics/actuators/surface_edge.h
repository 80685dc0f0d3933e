// SPDX-License-Identifier: BSD-3-Clause
// The edge of an open surface, as loops.
#pragma once

#include <vector>

#include "soft_robot_lab/mechanics/tet_mesh.h"

namespace soft_robot_lab {

struct EdgeOfFace {
  int from = -1, to = -1;  // corners, in the turning sense of the face that has the edge
  int middle = -1;         // mid-edge node, or -1 on linear faces
};

// The closed loops of edges that belong to one face only; none for a closed surface. Throws std::invalid_argument with
// the place where faces turn against each other, or more than two loops' ends meet in a node.
std::vector<std::vector<EdgeOfFace>> edge_loops(const TetMesh& mesh, const std::vector<int>& faces);

}  // namespace soft_robot_lab
