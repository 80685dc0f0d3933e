// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "soft_robot_lab/mechanics/tet_mesh.h"

namespace soft_robot_lab {

// Throws std::invalid_argument with the endings that read_mesh_file() knows where a file has another one.
void require_mesh_ending(const std::string& file);

// Reads a mesh whose file has lengths in `unit_m`: .msh of any version, text or binary, or .vtk. Physical surfaces
// become named ones. Throws std::invalid_argument or, from Gmsh, std::string.
TetMesh read_mesh_file(const std::string& file, double unit_m);

// Gives the triangles of named surfaces the node order of the elements that they bound. Throws std::invalid_argument
// with the place where one bounds none, or lies between two.
void turn_faces_outward(TetMesh& mesh);

// Both, checked.
TetMesh convert_mesh(const std::string& file, double unit_m);

}  // namespace soft_robot_lab
