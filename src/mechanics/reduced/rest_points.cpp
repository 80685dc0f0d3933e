// SPDX-License-Identifier: BSD-3-Clause
#include "rest_points.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "mechanics/mesh/shape_functions.h"

namespace soft_robot_lab {
namespace {

PointGradient point_gradient(const Eigen::VectorXi& nodes, const Eigen::Matrix3Xd& slopes,
                             const Eigen::MatrixXd& modes) {
  PointGradient gradient = PointGradient::Zero(9, modes.cols());
  for (Eigen::Index a = 0; a < nodes.size(); ++a)
    for (int axis = 0; axis < 3; ++axis)
      gradient.middleRows<3>(3 * axis) += slopes(axis, a) * modes.middleRows<3>(3 * nodes[a]);
  return gradient;
}

}  // namespace

std::vector<RestPoint> rest_points(const TetMesh& mesh, const Eigen::MatrixXd& modes) {
  std::vector<RestPoint> points;
  const int corners = static_cast<int>(mesh.tets.rows());
  for (int e = 0; e < mesh.tet_count(); ++e) {
    const Eigen::VectorXi nodes = mesh.tets.col(e);
    Eigen::Matrix3Xd places(3, corners);
    for (int a = 0; a < corners; ++a) places.col(a) = mesh.nodes_m.col(nodes[a]);
    for (const Eigen::Vector3d& local : tet_quadrature_points()) {
      const ShapeFunctions shape = shape_functions(corners, local);
      const Eigen::Matrix3d jacobian = places * shape.gradients.transpose();
      const Eigen::Matrix3Xd slopes = jacobian.transpose().inverse() * shape.gradients;
      points.push_back({e, jacobian.determinant() / 24.0, point_gradient(nodes, slopes, modes)});
    }
  }
  return points;
}

FlatMatrix tensor_cross(const Eigen::Ref<const FlatMatrix>& a, const Eigen::Ref<const FlatMatrix>& b) {
  FlatMatrix result;
  for (int c = 0; c < 3; ++c) {
    const int u = 3 * ((c + 1) % 3), v = 3 * ((c + 2) % 3);
    const Eigen::Vector3d au = a.segment<3>(u), av = a.segment<3>(v), bu = b.segment<3>(u), bv = b.segment<3>(v);
    result.segment<3>(3 * c) = au.cross(bv) + bu.cross(av);
  }
  return result;
}

}  // namespace soft_robot_lab
