// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz_mesh.h"

#include <cmath>
#include <stdexcept>

#include "fuzz_rules.h"
#include "programs/mesher/read_vtk.h"
#include "soft_robot_lab/mechanics/tet_mesh.h"

namespace soft_robot_lab {
namespace {

// A mesh that was read has finite places; one that is sound has a volume, in either order.
void use(const TetMesh& mesh) {
  require_rule(mesh.nodes_m.allFinite());
  check_mesh(mesh);
  const double volume_m3 = volume(mesh);
  require_rule(volume_m3 > 0 || !std::isfinite(volume_m3));
  check_mesh(make_linear(mesh));
  if (mesh.tet_count() < 10000) require_rule(make_quadratic(mesh).quadratic());
}

template <typename Read>
void attempt(const Read& read) {
  try {
    use(read());
  } catch (const std::invalid_argument& error) {
    require_rule(*error.what() != '\0');
  }
}

}  // namespace

// What is wrong with a file is said by std::invalid_argument and by nothing else.
void fuzz_mesh(const std::uint8_t* data, std::size_t size) {
  const FuzzFile file(data, size);
  attempt([&] { return read_msh(file.path()); });
  attempt([&] { return read_vtk(file.path()); });
}

}  // namespace soft_robot_lab
