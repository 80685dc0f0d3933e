// SPDX-License-Identifier: BSD-3-Clause
// The points of a body's skin at which contact acts: some inside each boundary face. The corner functions of a
// quadratic triangle integrate to zero, so forces at nodes would miss a uniform pressure.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {

constexpr int kPointsPerFace = 3;  // of the sparse spread

enum class PointSpread {
  sparse,  // three in a face: enough for what is smooth
  dense,   // twelve: for other skin, which has edges
};

class ContactPoints {
 public:
  ContactPoints() = default;  // none
  // Of all faces that can move.
  explicit ContactPoints(const Body& body, PointSpread spread = PointSpread::sparse);

  int count() const { return static_cast<int>(weights_m2_.size()); }
  int face_count() const { return static_cast<int>(faces_.cols()); }
  int nodes_per_face() const { return static_cast<int>(faces_.rows()); }
  int face_of(int point) const { return point / per_face_; }
  int first_point(int face) const { return per_face_ * face; }

  int node(int face, int corner) const { return faces_(corner, face); }
  const Eigen::MatrixXi& faces() const { return faces_; }             // nodes x faces
  const std::vector<int>& mesh_faces() const { return mesh_faces_; }  // which of the mesh's they are
  // Of the face's nodes at the point.
  auto shape(int point) const { return shape_.col(point % per_face_); }
  double weight_m2(int point) const { return weights_m2_[point]; }          // share of the rest area
  double face_size_m(int point) const { return sizes_m_[face_of(point)]; }  // edge of half a square of its area

  Eigen::Vector3d at(int point, const Eigen::Matrix3Xd& columns) const;              // the nodes' columns, interpolated
  double present_area_m2(int point, const Eigen::Matrix3Xd& positions_m) const;      // what weight_m2 has become
  Eigen::Vector3d outward_m2(int point, const Eigen::Matrix3Xd& positions_m) const;  // normal, as long as that

 private:
  int per_face_ = kPointsPerFace;
  Eigen::MatrixXi faces_;
  std::vector<int> mesh_faces_;
  Eigen::MatrixXd shape_;              // nodes x points of a face
  Eigen::MatrixXd along_r_, along_s_;  // its derivatives
  Eigen::VectorXd weights_m2_, sizes_m_;
};

}  // namespace soft_robot_lab
