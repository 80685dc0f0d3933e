// SPDX-License-Identifier: BSD-3-Clause
// Solids as geometry of Gmsh's Open CASCADE kernel.
#pragma once

#include <vector>

#include <gmsh.h>

#include "soft_robot_lab/robot/design/solid.h"

namespace soft_robot_lab {

// The kernel works in millimetres, for which its tolerances (1e-7) are made.
constexpr double kKernelUnitsPerMetre = 1000.0;

// Adds the solid to the current model, which is synchronised; returns its volumes.
// Throws std::invalid_argument for a file that holds no solid.
gmsh::vectorpair build_solid(const Solid& solid);

// The same as one volume. Throws std::invalid_argument when the solid is empty or falls into parts.
int build_body(const Solid& solid);

}  // namespace soft_robot_lab
