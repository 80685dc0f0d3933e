// SPDX-License-Identifier: BSD-3-Clause
// The boundary of a solid, without elements inside: as triangles, or as STEP.
#pragma once

#include <string>

#include "soft_robot_lab/robot/design/mesher.h"

namespace soft_robot_lab {

struct SurfaceRequest {
  Solid solid;
  double largest_edge_m = 0.01;  // > 0
  double edges_across = 0;       // [0, 1000]; above 0 the largest edge is this share of the diagonal of the solid's box
  int circle_segments = 48;      // [6, 360]: edges around a full circle
  double smallest_edge_m = 0;    // >= 0, where circles ask for less; 0: a 200th of the largest
};

// The path of an OFF file: vertices in metres with 17 digits; triangles turned as the kernel has them, each with the
// number of the geometry's face and its normal at the centre, 0 where it is flat ("3 a b c FACE NX NY NZ"). An STL body
// keeps its own triangles. Throws as mesh_file_for does.
std::string surface_file_for(const SurfaceRequest& request, const MesherOptions& options);

// The path of a STEP file of a solid, in millimetres. An STL body has none. Throws as mesh_file_for does.
std::string step_file_for(const Solid& solid, const MesherOptions& options);

}  // namespace soft_robot_lab
