// SPDX-License-Identifier: BSD-3-Clause
// The outer skin of a body as triangles that follow its nodes.
#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "soft_robot_lab/mechanics/tet_mesh.h"

namespace soft_robot_lab {

// Without the surfaces of cavities that are closed all round. A linear face is one triangle; a quadratic one is cut by
// its own shape functions into cuts^2, so that curved faces look curved. Frame: the nodes'.
class Skin {
 public:
  // The mesh's faces must cover its boundary (complete_boundary). Cuts of a quadratic face's side: [1, 64], else
  // std::invalid_argument.
  explicit Skin(const TetMesh& mesh, int cuts = 4);

  const Eigen::Matrix3Xi& triangles() const { return triangles_; }  // outward, index the columns of vertices_m
  Eigen::Matrix3Xd vertices_m(const Eigen::Matrix3Xd& positions_m) const { return positions_m * weights_; }

 private:
  Eigen::Matrix3Xi triangles_;
  Eigen::SparseMatrix<double> weights_;  // nodes x vertices
};

// The faces of the boundary's outer part.
std::vector<int> outer_faces(const TetMesh& mesh);

}  // namespace soft_robot_lab
