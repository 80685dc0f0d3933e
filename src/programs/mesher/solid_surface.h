// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "soft_robot_lab/robot/design/solid.h"

namespace soft_robot_lab {

struct SurfaceSizes {
  double largest_edge_m = 0.01;
  double edges_across = 0;  // above 0: the largest edge is this share of the diagonal of the solid's box
  int circle_segments = 48;
  double smallest_edge_m = 0;  // 0: a share of the largest
};

// Writes the solid's boundary as robot/design/surface_file.h describes. Throws std::invalid_argument or, from Gmsh,
// std::string.
void write_surface(const Solid& solid, const SurfaceSizes& sizes, const std::string& path);

// Writes the solid as STEP in millimetres; the path ends with .step. Throws alike.
void write_step(const Solid& solid, const std::string& path);

}  // namespace soft_robot_lab
