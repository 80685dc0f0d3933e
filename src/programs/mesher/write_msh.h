// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "soft_robot_lab/mechanics/tet_mesh.h"

namespace soft_robot_lab {

// Writes MSH 2.2 text: the volume "body" and the faces of named surfaces. Numbers read back as they were.
void write_msh(const TetMesh& mesh, const std::string& path);

}  // namespace soft_robot_lab
