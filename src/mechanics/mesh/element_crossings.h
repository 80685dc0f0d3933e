// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/mechanics/tet_mesh.h"

namespace soft_robot_lab {

using TetCorners = Eigen::Matrix<double, 3, 4>;
TetCorners corners_of(const TetMesh& mesh, int tet);
double edge_m(const TetMesh& mesh, int tet);  // of a regular element of its volume

// A straight line's way through an element, in shares of the line.
struct ElementCrossing {
  int tet;
  double from, to;
};

// Through every element whose corners span a tetrahedron that the line crosses, in the line's order. One that it only
// touches, by less than a hundredth of the element's longest edge, does not count; along a face or an edge that
// elements share, one of them does.
std::vector<ElementCrossing> element_crossings(const TetMesh& mesh, const Eigen::Vector3d& from_m,
                                               const Eigen::Vector3d& to_m);

}  // namespace soft_robot_lab
