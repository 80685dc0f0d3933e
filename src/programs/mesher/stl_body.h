// SPDX-License-Identifier: BSD-3-Clause
// An STL file as a body: alone, or turned, moved, scaled and mirrored as a whole.
#pragma once

#include <string>

#include "soft_robot_lab/robot/design/solid.h"

namespace soft_robot_lab {

bool is_stl_body(const Solid& solid);
std::string stl_file(const Solid& solid);  // its path

// Reads the file into Gmsh's present model and moves its points. Throws std::invalid_argument where its surface bounds
// no body, or std::string, as Gmsh does.
void merge_stl(const Solid& solid);

// The name that its surface has: the outermost; may be empty.
std::string stl_name(const Solid& solid);

}  // namespace soft_robot_lab
