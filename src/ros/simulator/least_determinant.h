// SPDX-License-Identifier: BSD-3-Clause
// How far the silicone is squeezed together.
#pragma once

#include <Eigen/Core>

#include "soft_robot_lab/mechanics/tet_mesh.h"

namespace soft_robot_lab {

// The least det F at the elements' corners and centres: 1 at rest, 0 where an element is flat, below where it is turned
// over. `positions_m`: of the mesh's nodes, 3 x nodes.
double least_determinant(const TetMesh& mesh, const Eigen::Matrix3Xd& positions_m);

}  // namespace soft_robot_lab
