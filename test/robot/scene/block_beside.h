// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace soft_robot_lab {

// A second body beside the first.
inline const char* const kBlockBeside =
    "bodies: [{name: block, solid: {box: {size_m: [0.02, 0.02, 0.02], center_m: [0.2, 0, 0]}}, element_size_m: 0.02, "
    "material: {youngs_modulus_pa: 100000, poissons_ratio: 0.4, density_kg_m3: 1000}, "
    "fixed: [{box: {min_m: [-1, -1, -1], max_m: [1, 1, 1]}}]}]\n";

}  // namespace soft_robot_lab
