// SPDX-License-Identifier: BSD-3-Clause
// A mesh that rays and balls are tried against: Embree's tree, in single precision, which is built once and refitted
// where the vertices move.
#pragma once

#include <functional>
#include <memory>

#include <Eigen/Core>

namespace soft_robot_lab {

struct MeshHit {
  int triangle = -1;   // -1 where nothing is met
  float depth = 0;     // in units of the ray's direction
  float u = 0, v = 0;  // weights of the triangle's corners 1 and 2
};

class MeshTree {
 public:
  enum class Use { still, moving };

  MeshTree(const Eigen::Matrix3Xd& vertices_m, const Eigen::Matrix3Xi& triangles, Use use);
  ~MeshTree();

  void move(const Eigen::Matrix3Xd& vertices_m);
  // The first triangle beyond `near` directions.
  MeshHit cast(const Eigen::Vector3f& origin_m, const Eigen::Vector3f& direction, float near = 0.0f) const;
  // Calls `visit` for triangles whose boxes come within the radius, and perhaps for others.
  void visit_near(const Eigen::Vector3f& point_m, float radius_m, const std::function<void(int)>& visit) const;

 private:
  struct Embree;
  std::unique_ptr<Embree> embree_;
};

}  // namespace soft_robot_lab
