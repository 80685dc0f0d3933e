// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <Eigen/Core>

#include "embedding.h"

namespace soft_robot_lab {

// A named point that cameras follow: inside the body, or off it on a rigid stalk that turns with the nearest skin
// point's frame (the rotation of the polar decomposition of its deformation gradient).
class Marker {
 public:
  Marker(std::string name, const Eigen::Vector3d& rest_position_m, const TetMesh& mesh, const MeshLocator& locator);

  const std::string& name() const { return name_; }
  const Eigen::Vector3d& rest_position_m() const { return rest_position_m_; }
  Eigen::Vector3d position(const Eigen::Matrix3Xd& positions_m) const;

  // How the marker moves when the nodes move by `motion_m` (3 x nodes): the derivative of `position`.
  Eigen::Vector3d velocity(const Eigen::Matrix3Xd& positions_m, const Eigen::Matrix3Xd& motion_m) const;

  // Adds the forces on the nodes [N], 3 x nodes, that do the work of a force at the marker: `velocity` transposed.
  void add_force(const Eigen::Matrix3Xd& positions_m, const Eigen::Vector3d& force_n, Eigen::Matrix3Xd& forces_n) const;

 private:
  Eigen::Matrix3d gradient_of(const Eigen::Matrix3Xd& field_m) const;  // by rest place, at the root

  std::string name_;
  Eigen::Vector3d rest_position_m_;
  EmbeddedPoint root_;
  Eigen::Vector3d stalk_m_ = Eigen::Vector3d::Zero();   // rest offset from the root; zero inside
  Eigen::Matrix<double, 3, Eigen::Dynamic> gradients_;  // of the root element's shape functions, for the frame
};

}  // namespace soft_robot_lab
