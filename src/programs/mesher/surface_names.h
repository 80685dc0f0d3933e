// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "gmsh_model.h"
#include "soft_robot_lab/robot/design/solid.h"

namespace soft_robot_lab {

// Names the surfaces of the current model's body after the solids they came from: a surface belongs to a named solid
// when its triangles lie on that solid's own boundary. Of several the one nested deepest counts, of those the last one.
// The body must have been meshed.
std::vector<NamedSurface> name_surfaces(int body, const Solid& solid);

}  // namespace soft_robot_lab
