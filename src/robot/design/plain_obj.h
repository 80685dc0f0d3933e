// SPDX-License-Identifier: BSD-3-Clause
// Wavefront OBJ: "Object Files (.obj)", Advanced Visualizer, appendix B1.
#pragma once

#include <string>

namespace soft_robot_lab {

// The faces of an OBJ file as text of an STL file, in triangles around their first corner. Names, groups, materials,
// normals and places on textures are passed over. Throws std::invalid_argument, with the line, for what is no OBJ, a
// face of fewer than three corners or of vertices that are not there, and as plain_stl does.
std::string plain_obj(const std::string& bytes);

}  // namespace soft_robot_lab
