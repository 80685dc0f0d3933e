// SPDX-License-Identifier: BSD-3-Clause
// What must hold of a mesh that a reader gives.
#pragma once

#include <cmath>
#include <stdexcept>

#include "fuzz_rules.h"
#include "soft_robot_lab/mechanics/tet_mesh.h"

namespace soft_robot_lab {

// Its places are finite; one that is sound has a volume, in either order. Throws std::invalid_argument for others.
inline void use_mesh(const TetMesh& mesh) {
  require_rule(mesh.nodes_m.allFinite());
  check_mesh(mesh);
  const double volume_m3 = volume(mesh);
  require_rule(volume_m3 > 0 || !std::isfinite(volume_m3));
  check_mesh(make_linear(mesh));
  if (mesh.tet_count() < 10000) require_rule(make_quadratic(mesh).quadratic());
}

// What is wrong with a file is said by std::invalid_argument and by nothing else.
template <typename Read>
void attempt_to_read(const Read& read) {
  try {
    read();
  } catch (const std::invalid_argument& error) {
    require_rule(*error.what() != '\0');
  }
}

}  // namespace soft_robot_lab
