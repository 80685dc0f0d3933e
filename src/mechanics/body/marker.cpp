// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/mechanics/marker.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

#include "mechanics/mesh/shape_functions.h"

namespace soft_robot_lab {
namespace {

struct Polar {
  Eigen::Matrix3d rotation, stretch;  // F = rotation * stretch
};

Polar polar(const Eigen::Matrix3d& f) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU(), v = svd.matrixV();
  Eigen::Vector3d s = svd.singularValues();
  if ((u * v.transpose()).determinant() < 0.0) {
    u.col(2) *= -1.0;
    s[2] *= -1.0;
  }
  return {u * v.transpose(), v * s.asDiagonal() * v.transpose()};
}

}  // namespace

Marker::Marker(std::string name, const Eigen::Vector3d& rest_position_m, const TetMesh& mesh,
               const MeshLocator& locator)
    : name_(std::move(name)), rest_position_m_(rest_position_m) {
  const Location location = locator.locate(rest_position_m);
  root_ = locator.embed(location);
  stalk_m_ = rest_position_m - location.nearest_m;
  if (location.distance_m == 0.0) stalk_m_.setZero();
  const ShapeFunctions shape = shape_functions(static_cast<int>(mesh.tets.rows()), location.local);
  Eigen::Matrix3d jacobian = Eigen::Matrix3d::Zero();
  for (Eigen::Index a = 0; a < mesh.tets.rows(); ++a)
    jacobian += mesh.nodes_m.col(mesh.tets(a, location.tet)) * shape.gradients.col(a).transpose();
  gradients_ = jacobian.inverse().transpose() * shape.gradients;
}

Eigen::Vector3d Marker::position(const Eigen::Matrix3Xd& positions_m) const {
  const Eigen::Vector3d root = root_.at(positions_m);
  if (stalk_m_.isZero(0.0)) return root;
  Eigen::Matrix3d f = Eigen::Matrix3d::Zero();
  for (std::size_t a = 0; a < root_.nodes.size(); ++a)
    f += positions_m.col(root_.nodes[a]) * gradients_.col(static_cast<Eigen::Index>(a)).transpose();
  return root + polar(f).rotation * stalk_m_;
}

Eigen::Vector3d Marker::velocity(const Eigen::Matrix3Xd& positions_m, const Eigen::Matrix3Xd& motion_m) const {
  const Eigen::Vector3d root = root_.at(motion_m);
  if (stalk_m_.isZero(0.0)) return root;
  Eigen::Matrix3d f = Eigen::Matrix3d::Zero(), df = Eigen::Matrix3d::Zero();
  for (std::size_t a = 0; a < root_.nodes.size(); ++a) {
    const auto gradient = gradients_.col(static_cast<Eigen::Index>(a)).transpose();
    f += positions_m.col(root_.nodes[a]) * gradient;
    df += motion_m.col(root_.nodes[a]) * gradient;
  }
  // dR = R [w]x with (tr(S) I - S) w = axial(R^T dF - dF^T R).
  const Polar parts = polar(f);
  const Eigen::Matrix3d skew = parts.rotation.transpose() * df - df.transpose() * parts.rotation;
  const Eigen::Vector3d axial(skew(2, 1), skew(0, 2), skew(1, 0));
  const Eigen::Matrix3d stiffness = parts.stretch.trace() * Eigen::Matrix3d::Identity() - parts.stretch;
  return root + parts.rotation * stiffness.partialPivLu().solve(axial).cross(stalk_m_);
}

}  // namespace soft_robot_lab
