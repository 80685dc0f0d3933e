// SPDX-License-Identifier: BSD-3-Clause
// Solids as geometry of Gmsh's Open CASCADE kernel.
#pragma once

#include <string>
#include <vector>

#include <gmsh.h>

#include "gmsh_model.h"
#include "soft_robot_lab/robot/design/solid.h"

namespace soft_robot_lab {

// The kernel works in millimetres, for which its tolerances (1e-7) are made.
constexpr double kKernelUnitsPerMetre = 1000.0;

// Adds the solid to the current model, which is synchronised; returns its volumes.
// Throws std::invalid_argument for a file that holds no solid.
gmsh::vectorpair build_solid(const Solid& solid);

// The same as one volume. Throws std::invalid_argument when the solid is empty or falls into parts.
int build_body(const Solid& solid);

// Cuts the body along the solids of these names. Returns what lies in each, and first, without a name, the rest: what a
// solid that counts more (named_solids) has taken, others do not have. Empty where there are no names.
std::vector<NamedEntities> cut_body(int body, const Solid& solid, const std::vector<std::string>& names);

}  // namespace soft_robot_lab
