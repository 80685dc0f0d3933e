// SPDX-License-Identifier: BSD-3-Clause
// A rigid solid that triangles bound. Its gap is the distance to the surface on which the spline over its distances is
// zero (distance_grid.h): once continuously differentiable across edges outside, with exact derivatives near the
// surface. All in the frame in which its vertices are stated.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "closed_surface.h"
#include "distance_grid.h"
#include "gap.h"
#include "triangle_tree.h"

namespace soft_robot_lab {

struct MeshEdge {
  Eigen::Vector3d from_m, to_m;
  std::array<Eigen::Vector3d, 2> normals;  // of the faces that meet in it
};

class MeshSolid {
 public:
  // Edges are rounded by this, the grid's step; 0: by a 64th of its size, or less where it has thin walls or fine
  // details. Throws std::invalid_argument as ClosedSurface does, and where the grid would be too large or too coarse.
  MeshSolid(const Eigen::Matrix3Xd& vertices_m, const Eigen::Matrix3Xi& triangles, double rounding_m);

  const ClosedSurface& surface() const { return surface_; }
  double rounding_m() const { return grid_.step_m(); }
  Gap gap(const Eigen::Vector3d& point_m) const;
  // For the middle of a ball with this radius: of large ones, of a step and more, the distance to the triangles
  // themselves, whose edges need no rounding then.
  Gap gap_of_ball(const Eigen::Vector3d& point_m, double radius_m) const;

  // To the triangles themselves, negative inside: of no use near their edges where a derivative is asked for.
  double sharp_gap_m(const Eigen::Vector3d& point_m) const;

  bool flat() const { return flat_; }  // mostly of flat faces that are no facets of round ones
  double bounding_radius_m() const { return bounding_radius_m_; }   // about its centroid
  double half_thickness_m() const { return half_thickness_m_; }     // but of a twentieth of its surface at least
  const Eigen::Vector3d& deepest_m() const { return deepest_m_; }   // farthest inside
  const Eigen::Matrix3Xd& corners_m() const { return corners_m_; }  // vertices at edges that stand out
  // Of the edges that stand out those that corners do not stand for; the surface between the ends of others is nearer
  // to them than its edges are rounded.
  const std::vector<MeshEdge>& edges() const { return edges_; }
  bool edges_are_all() const { return edges_are_all_; }  // there are no others
  // In triangles, beside their corners, two steps from their sides: where another mesh's rounded edges do not matter.
  const Eigen::Matrix3Xd& beside_corners_m() const { return beside_corners_m_; }

 private:
  ClosedSurface surface_;
  double half_thickness_m_ = 0.0;
  DistanceGrid grid_;
  TriangleTree tree_;
  bool flat_;
  double bounding_radius_m_;
  Eigen::Vector3d deepest_m_;
  Eigen::Matrix3Xd corners_m_, beside_corners_m_;
  bool edges_are_all_ = true;
  std::vector<MeshEdge> edges_;
};

}  // namespace soft_robot_lab
