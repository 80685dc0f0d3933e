// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz_mesh.h"

#include "fuzz_rules.h"
#include "use_mesh.h"

namespace soft_robot_lab {

void fuzz_mesh(const std::uint8_t* data, std::size_t size) {
  const FuzzFile file(data, size);
  attempt_to_read([&] { use_mesh(read_msh(file.path())); });
}

}  // namespace soft_robot_lab
