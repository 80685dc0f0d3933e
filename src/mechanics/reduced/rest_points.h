// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/mechanics/tet_mesh.h"

namespace soft_robot_lab {

// 9 x modes: with reduced coordinates q the displacement gradient of a point is A = D q, column after column.
using PointGradient = Eigen::Matrix<double, 9, Eigen::Dynamic>;

struct RestPoint {
  int element;
  double weight_m3;  // rest volume that it stands for
  PointGradient gradient;

  Eigen::Matrix3d displacement_gradient(const Eigen::VectorXd& q) const {
    Eigen::Matrix3d a;
    Eigen::Map<Eigen::Matrix<double, 9, 1>>(a.data()).noalias() = gradient * q;
    return a;
  }
};

inline Eigen::VectorXd traces(const PointGradient& d) { return (d.row(0) + d.row(4) + d.row(8)).transpose(); }

// The quadrature points of all elements, four each; `modes`: displacements over 3*node + axis, one column a mode.
std::vector<RestPoint> rest_points(const TetMesh& mesh, const Eigen::MatrixXd& modes);

// Matrices column after column.
using FlatMatrix = Eigen::Matrix<double, 9, 1>;

// A x B with  cof(A + B) = cof A + A x B + cof B;  half of A x A is cof A, the gradient of det A.
FlatMatrix tensor_cross(const Eigen::Ref<const FlatMatrix>& a, const Eigen::Ref<const FlatMatrix>& b);

}  // namespace soft_robot_lab
