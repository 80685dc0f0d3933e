#pragma once

#include "programs/mesher/mesh_sizes.h"
#include "soft_robot_lab/design/solid.h"
#include "soft_robot_lab/sim/tet_mesh.h"

namespace soft_robot_lab {

// Throws std::invalid_argument or, from Gmsh, std::string.
TetMesh mesh_solid(const Solid& solid, const MeshSizes& sizes);

}  // namespace soft_robot_lab
