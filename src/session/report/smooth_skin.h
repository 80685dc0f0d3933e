// SPDX-License-Identifier: BSD-3-Clause
// What makes a body's skin look round and solid: the true normals of its curved faces, and how open each place is to
// the light around it.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/mechanics/tet_mesh.h"

namespace soft_robot_lab {

class SmoothSkin {
 public:
  // Edges at which the rest shape turns by more than 40 degrees stay sharp.
  explicit SmoothSkin(const TetMesh& mesh);

  // Triangles of all faces, four of a face with mid-edge nodes: at each corner a node, and the number of its normal.
  struct Corner {
    int node, normal;
  };
  struct Triangle {
    std::array<Corner, 3> corners;
    int face;  // a column of TetMesh::faces
  };
  const std::vector<Triangle>& triangles() const { return triangles_; }

  // Outward unit vectors, one a number: the mean of the faces that meet there, by their shape functions.
  Eigen::Matrix3Xd normals(const Eigen::Matrix3Xd& positions_m) const;

  // Per normal, how much of the sky over it the body itself leaves open in the rest shape, (0, 1]: rays weighed by
  // their cosine, as far as a third of the body's size. Places in a closed cavity are as dark as they get.
  const Eigen::VectorXd& openness() const { return openness_; }

 private:
  void group_corners(const TetMesh& mesh);
  void cut_faces();
  void measure_openness(const TetMesh& mesh);

  Eigen::MatrixXi faces_;    // nodes
  Eigen::MatrixXi normals_;  // of each node of each face the number of its normal
  int normal_count_ = 0;
  std::vector<Triangle> triangles_;
  Eigen::VectorXd openness_;
};

}  // namespace soft_robot_lab
