// SPDX-License-Identifier: BSD-3-Clause
// The files of others that a body is made of. Gmsh takes whatever it does not know for a script of its own, which may
// run programs: each file is checked here, by its name's ending and by its content, before Gmsh sees a copy of it.
#pragma once

#include <string>

namespace soft_robot_lab {

enum class MeshFormat { msh, vtk, stl, step, obj };

// .msh, .vtk, .stl, .obj, and .step or .stp, in any case.
bool has_ending_of(const std::string& file, MeshFormat format);

// ".msh": what Gmsh knows the format by.
std::string ending_of(MeshFormat format);

// What may be handed to Gmsh in the file's place: the bytes as they are, or the triangles of an STL or OBJ file alone,
// as STL in the form that Gmsh reads. Throws std::invalid_argument where the content is not of the format.
std::string safe_content(std::string bytes, MeshFormat format);

}  // namespace soft_robot_lab
