// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gmsh.h>

#include "gmsh_model.h"
#include "soft_robot_lab/robot/design/solid.h"

namespace soft_robot_lab {

// Names the outer surfaces of the current model's body, given by its volumes, after the solids they came from: a
// surface belongs to a named solid when its triangles lie on that solid's own boundary. Of several the one nested
// deepest counts, of those the last one. The body must have been meshed.
std::vector<NamedEntities> name_surfaces(const gmsh::vectorpair& volumes, const Solid& solid);

}  // namespace soft_robot_lab
