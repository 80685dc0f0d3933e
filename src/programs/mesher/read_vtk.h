// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "soft_robot_lab/mechanics/tet_mesh.h"

namespace soft_robot_lab {

// Reads the tetrahedra of a legacy .vtk file (text or binary, also with the cells of version 5.1, which Gmsh refuses).
// Points keep their order, those of no tetrahedron are left out. The format has no named surfaces.
// Throws std::invalid_argument naming file and, for text, line.
TetMesh read_vtk(const std::string& path);

}  // namespace soft_robot_lab
