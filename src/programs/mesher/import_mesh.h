// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "soft_robot_lab/mechanics/tet_mesh.h"

namespace soft_robot_lab {

struct ImportedMesh {
  TetMesh mesh;                      // checked
  std::vector<std::string> hollows;  // names of surfaces
  int turned = 0;                    // elements whose nodes stood in the wrong order
  int joined = 0;                    // nodes of separate pieces that lay at the same places
};

// A mesh as other programs write it: elements with a wrong order of nodes are turned, pieces whose nodes coincide are
// joined, and each closed part of the boundary gets a name where the file has none: `skin`, `cavity`, `cavity_2`, ...
// Throws as convert_mesh and check_mesh do.
ImportedMesh import_mesh(const std::string& file, double unit_m);

}  // namespace soft_robot_lab
