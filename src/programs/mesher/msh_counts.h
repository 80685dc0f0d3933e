// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace soft_robot_lab {

// Throws std::invalid_argument, with the line of a text file, where $Nodes or $Elements of an .msh file announce
// another number than follows: Gmsh reads as many as are announced and goes on. What else is wrong with a file is left
// to Gmsh.
void check_msh_counts(const std::string& file);

}  // namespace soft_robot_lab
