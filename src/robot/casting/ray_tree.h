// SPDX-License-Identifier: BSD-3-Clause
// Rays and balls against a surface. What the tree finds in single precision is computed anew in double precision.
#pragma once

#include <functional>
#include <optional>

#include "geometry/mesh_tree.h"
#include "surface.h"

namespace soft_robot_lab {

struct SurfaceHit {
  int triangle = -1;
  double distance_m = 0;  // along the unit direction
};

class RayTree {
 public:
  explicit RayTree(const Surface& surface);  // keeps a reference

  // The first triangle after `near_m`; nothing where there is none. The direction has unit length.
  std::optional<SurfaceHit> first_hit(const Eigen::Vector3d& origin_m, const Eigen::Vector3d& direction,
                                      double near_m) const;

  // Calls `visit` for triangles whose boxes come within the radius, and perhaps for others.
  void near(const Eigen::Vector3d& point_m, double radius_m, const std::function<void(int)>& visit) const;

  const Surface& surface() const { return surface_; }
  double size_m() const { return size_m_; }  // the surface's, which takes all its vertices to find
  double skip_m() const { return skip_m_; }  // what a ray leaves out to miss the triangle that it starts on

 private:
  const Surface& surface_;
  double size_m_, skip_m_;
  MeshTree tree_;
};

// Where an edge of the surface passes through a triangle that it does not touch; nothing where none does.
std::optional<Eigen::Vector3d> find_crossing(const RayTree& tree);

// The point of a triangle that is nearest to another point.
Eigen::Vector3d nearest_point(const Surface& surface, int triangle, const Eigen::Vector3d& point_m);

}  // namespace soft_robot_lab
