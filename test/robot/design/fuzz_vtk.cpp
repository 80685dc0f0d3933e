// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz_vtk.h"

#include <unistd.h>

#include <filesystem>
#include <string>

#include "fuzz_rules.h"
#include "programs/mesher/read_vtk.h"
#include "programs/mesher/write_msh.h"
#include "use_mesh.h"

namespace soft_robot_lab {
namespace {

bool are_same(const TetMesh& one, const TetMesh& other) {
  return one.nodes_m == other.nodes_m && one.tets.rows() == other.tets.rows() && one.tets == other.tets;
}

struct KeptFile {
  const std::string path = std::filesystem::temp_directory_path() / ("fuzz_vtk." + std::to_string(getpid()) + ".msh");
  ~KeptFile() { std::filesystem::remove(path); }
};

}  // namespace

// A mesh that is read is read again alike, and comes back from the MSH file that the mesher makes of it.
void fuzz_vtk(const std::uint8_t* data, std::size_t size) {
  const FuzzFile file(data, size);
  attempt_to_read([&] {
    const TetMesh mesh = read_vtk(file.path());
    require_rule(are_same(mesh, read_vtk(file.path())));
    use_mesh(mesh);
    const KeptFile kept;
    write_msh(mesh, kept.path);
    require_rule(are_same(mesh, read_msh(kept.path)));
  });
}

}  // namespace soft_robot_lab
