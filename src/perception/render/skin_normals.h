// SPDX-License-Identifier: BSD-3-Clause
// Normals of a skin's corners: smooth where it is smooth, split along sharp edges.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

namespace soft_robot_lab {

class SkinNormals {
 public:
  // Edges that bend by more than 35 degrees in `rest_m` are sharp and stay so.
  SkinNormals(const Eigen::Matrix3Xd& rest_m, const Eigen::Matrix3Xi& triangles);

  void update(const Eigen::Matrix3Xd& vertices_m);
  Eigen::Vector3f at(int triangle, float u, float v) const;  // weights of corners 1 and 2; unit length
  Eigen::Vector3f of_face(int triangle) const { return face_normals_.col(triangle); }  // unit length

 private:
  Eigen::Matrix3Xi triangles_;
  Eigen::Matrix3Xi corner_group_;  // corners of one group share their normal
  Eigen::Matrix3Xf normals_;       // a column a group
  Eigen::Matrix3Xf face_normals_;  // a column a triangle
};

}  // namespace soft_robot_lab
