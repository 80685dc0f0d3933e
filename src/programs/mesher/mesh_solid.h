#pragma once

#include <vector>

#include "soft_robot_lab/design/mesher.h"
#include "soft_robot_lab/design/solid.h"
#include "soft_robot_lab/sim/tet_mesh.h"

namespace soft_robot_lab {

struct MeshSizes {
  double element_size_m = 0.01;  // longest edges, roughly
  bool quadratic = true;
  std::vector<MeshRefinement> refinements;
};

// Throws std::invalid_argument or, from Gmsh, std::string.
TetMesh mesh_solid(const Solid& solid, const MeshSizes& sizes);

}  // namespace soft_robot_lab
