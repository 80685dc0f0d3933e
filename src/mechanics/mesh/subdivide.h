// SPDX-License-Identifier: BSD-3-Clause
// Every element of a mesh cut into eight: the same body, twice as fine, nested in the coarse mesh.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/mechanics/embedding.h"
#include "soft_robot_lab/mechanics/tet_mesh.h"

namespace soft_robot_lab {

struct Subdivision {
  TetMesh mesh;  // the coarse nodes first, in their order; the children of element e are 8 e to 8 e + 7
  std::vector<EmbeddedPoint> parents;  // per node: the coarse nodes it lies between

  // What the coarse interpolation says at the fine nodes, 3 x nodes.
  Eigen::Matrix3Xd carry(const Eigen::Matrix3Xd& coarse) const;
};

// Red refinement (Bey 1995): four children at the corners, four around the shortest inner diagonal. Curved elements
// keep their shape. Only listed faces are cut too: call complete_boundary before, or after.
Subdivision subdivide(const TetMesh& coarse);

}  // namespace soft_robot_lab
