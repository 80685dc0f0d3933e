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

Eigen::Matrix3d Marker::gradient_of(const Eigen::Matrix3Xd& field_m) const {
  Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
  for (std::size_t a = 0; a < root_.nodes.size(); ++a)
    gradient += field_m.col(root_.nodes[a]) * gradients_.col(static_cast<Eigen::Index>(a)).transpose();
  return gradient;
}

Eigen::Vector3d Marker::position(const Eigen::Matrix3Xd& positions_m) const {
  const Eigen::Vector3d root = root_.at(positions_m);
  if (stalk_m_.isZero(0.0)) return root;
  return root + polar(gradient_of(positions_m)).rotation * stalk_m_;
}

Eigen::Vector3d Marker::velocity(const Eigen::Matrix3Xd& positions_m, const Eigen::Matrix3Xd& motion_m) const {
  const Eigen::Vector3d root = root_.at(motion_m);
  if (stalk_m_.isZero(0.0)) return root;
  const Eigen::Matrix3d df = gradient_of(motion_m);
  // dR = R [w]x with (tr(S) I - S) w = axial(R^T dF - dF^T R).
  const Polar parts = polar(gradient_of(positions_m));
  const Eigen::Matrix3d skew = parts.rotation.transpose() * df - df.transpose() * parts.rotation;
  const Eigen::Vector3d axial(skew(2, 1), skew(0, 2), skew(1, 0));
  const Eigen::Matrix3d stiffness = parts.stretch.trace() * Eigen::Matrix3d::Identity() - parts.stretch;
  return root + parts.rotation * stiffness.partialPivLu().solve(axial).cross(stalk_m_);
}

void Marker::add_force(const Eigen::Matrix3Xd& positions_m, const Eigen::Vector3d& force_n,
                       Eigen::Matrix3Xd& forces_n) const {
  for (std::size_t a = 0; a < root_.nodes.size(); ++a) forces_n.col(root_.nodes[a]) += root_.weights[a] * force_n;
  if (stalk_m_.isZero(0.0)) return;
  const Polar parts = polar(gradient_of(positions_m));
  const Eigen::Matrix3d stiffness = parts.stretch.trace() * Eigen::Matrix3d::Identity() - parts.stretch;
  const Eigen::Vector3d moment_nm = stalk_m_.cross(parts.rotation.transpose() * force_n);
  const Eigen::Vector3d turn = stiffness.partialPivLu().solve(moment_nm);
  Eigen::Matrix3d cross;
  cross << 0.0, -turn.z(), turn.y(), turn.z(), 0.0, -turn.x(), -turn.y(), turn.x(), 0.0;
  for (std::size_t a = 0; a < root_.nodes.size(); ++a)
    forces_n.col(root_.nodes[a]) += parts.rotation * cross * gradients_.col(static_cast<Eigen::Index>(a));
}

}  // namespace soft_robot_lab
