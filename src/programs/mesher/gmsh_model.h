// SPDX-License-Identifier: BSD-3-Clause
// What mesh_robot needs of Gmsh. Errors of Gmsh are thrown as std::string.
#pragma once

#include <string>
#include <vector>

#include "soft_robot_lab/mechanics/tet_mesh.h"

namespace soft_robot_lab {

// Gmsh between construction and destruction: silent, repeatable, without the user's own configuration files.
class GmshSession {
 public:
  GmshSession();
  ~GmshSession();
  GmshSession(const GmshSession&) = delete;
};

// Surfaces, or volumes, of the model that share a name.
struct NamedEntities {
  std::string name;
  std::vector<int> entities;
};

// The tetrahedra of the current model and the triangles of the named surfaces. Nodes stand in the order of their tags,
// those of no element are left out. The volumes become regions; none: the mesh is one. `unit_m` is the length of the
// model's unit.
TetMesh extract_mesh(const std::vector<NamedEntities>& surfaces, const std::vector<NamedEntities>& volumes,
                     double unit_m);

}  // namespace soft_robot_lab
