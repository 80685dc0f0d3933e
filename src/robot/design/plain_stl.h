// SPDX-License-Identifier: BSD-3-Clause
// STL: "StereoLithography Interface Specification", 3D Systems 1989.
#pragma once

#include <string>

namespace soft_robot_lab {

// The triangles of an STL file, text or binary, and nothing else of it: text with the lines that Gmsh waits for,
// numbers as they were written, solids without names; binary with an empty header and the right count. Throws
// std::invalid_argument, with the line of text or the number of a facet, for what is no STL, holds no or too many
// triangles, announces other ones than it holds, or has a corner that is no finite number or beyond 1e6 of its unit, or
// a body below 1e-9.
std::string plain_stl(const std::string& bytes);

}  // namespace soft_robot_lab
