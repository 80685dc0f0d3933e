// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "soft_robot_lab/mechanics/tet_mesh.h"

namespace soft_robot_lab {

// Reads a mesh in metres: .msh of any version, text or binary, or .vtk. Physical surfaces become named ones.
// Throws std::invalid_argument or, from Gmsh, std::string.
TetMesh convert_mesh(const std::string& file);

}  // namespace soft_robot_lab
