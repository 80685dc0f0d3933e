// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "gmsh_model.h"
#include "soft_robot_lab/robot/design/mesher.h"

namespace soft_robot_lab {

struct MeshSizes {
  double element_size_m = 0.01;  // longest edges, roughly
  bool quadratic = true;
  std::vector<MeshRefinement> refinements;

  bool name_surfaces() const;  // whether a refinement does
};

// Throws std::invalid_argument where so many elements are asked for that memory and time are not those of a robot.
// `of_file`: whether the solid's numbers are a file's, which the body's `scale` multiplies.
void check_count(double volume_m3, const MeshSizes& sizes, bool of_file);

// Gives Gmsh the sizes for the current model. Refinements that name surfaces need their entities; throws
// std::invalid_argument where there is no such surface.
void set_sizes(const MeshSizes& sizes, double units_per_metre, const std::vector<NamedEntities>& surfaces);

}  // namespace soft_robot_lab
