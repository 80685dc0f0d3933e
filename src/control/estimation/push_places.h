// SPDX-License-Identifier: BSD-3-Clause
// Places of the skin that something outside can touch.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/mechanics/body.h"
#include "soft_robot_lab/mechanics/embedding.h"

namespace soft_robot_lab {

struct PushPlace {
  Eigen::Index face = 0;
  double r = 0.0, s = 0.0;  // weights of the face's corners 1 and 2
  EmbeddedPoint at;
  double area_m2 = 0.0;  // of the rest skin that it stands for
};

// Faces cut into equal triangles, none of whose edges is longer than spacing_m at rest; their centres. Closed cavities
// and faces that are held whole are left out.
std::vector<PushPlace> push_places(const Body& body, double spacing_m);

// Outward unit normal where the nodes are at `positions_m`.
Eigen::Vector3d normal_at(const TetMesh& mesh, const Eigen::Matrix3Xd& positions_m, const PushPlace& place);

}  // namespace soft_robot_lab
