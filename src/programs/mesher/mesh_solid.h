// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mesh_sizes.h"
#include "soft_robot_lab/robot/design/solid.h"
#include "soft_robot_lab/mechanics/tet_mesh.h"

namespace soft_robot_lab {

// Throws std::invalid_argument or, from Gmsh, std::string.
TetMesh mesh_solid(const Solid& solid, const MeshSizes& sizes, const std::vector<std::string>& regions);

}  // namespace soft_robot_lab
