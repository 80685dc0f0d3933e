// SPDX-License-Identifier: BSD-3-Clause
// A closed surface of triangles that face out: what it encloses, and how far points are from its triangles.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "mechanics/mesh/nearest_on_triangle.h"

namespace soft_robot_lab {

class ClosedSurface {
 public:
  // Throws std::invalid_argument, with a place, where an edge has not one triangle on either side, or no volume is
  // enclosed.
  ClosedSurface(const Eigen::Matrix3Xd& vertices_m, const Eigen::Matrix3Xi& triangles);

  const Eigen::Matrix3Xd& vertices_m() const { return vertices_m_; }
  const Eigen::Matrix3Xi& triangles() const { return triangles_; }
  Eigen::Index count() const { return triangles_.cols(); }
  Eigen::Matrix3d corners_m(Eigen::Index triangle) const { return vertices_m_(Eigen::all, triangles_.col(triangle)); }
  Eigen::Vector3d normal(Eigen::Index triangle) const { return normals_.col(triangle); }  // zero without an area
  double area_m2(Eigen::Index triangle) const { return areas_m2_[triangle]; }
  // Of the place on a triangle that is nearest to a point: the point is outside where this points to it (Baerentzen &
  // Aanaes 2005).
  Eigen::Vector3d outward(Eigen::Index triangle, const NearestOnTriangle& place) const;

  // Of what it encloses, of density 1.
  double volume_m3() const { return volume_m3_; }
  const Eigen::Vector3d& centroid_m() const { return centroid_m_; }
  const Eigen::Matrix3d& inertia_m5() const { return inertia_m5_; }  // about the centroid

  // Edges that stand out, each once, in order of their vertices; and such as follow one another along a line in one.
  struct Edge {
    int from, to;
    std::array<Eigen::Vector3d, 2> normals;  // beside it

    double angle_rad() const;  // between these
  };
  std::vector<Edge> edges_standing_out() const;
  std::vector<Edge> lines_standing_out() const;
  std::vector<int> standing_out() const;  // vertices at these, in their order

  // Faces of several triangles in one plane, by their areas times their normals.
  std::vector<Eigen::Vector3d> faces_m2() const;
  // The axes of its largest face and, across that, of the next one. They do not depend on the order of triangles, and
  // turn with the surface unless several faces are equally large.
  Eigen::Matrix3d frame() const;

 private:
  void join_neighbours();
  void measure();

  Eigen::Matrix3Xd vertices_m_, normals_, of_corners_;  // the latter: of vertices, by the angles there
  Eigen::Matrix3Xi triangles_, neighbours_;             // across the sides
  Eigen::VectorXd areas_m2_;
  double volume_m3_ = 0.0;
  Eigen::Vector3d centroid_m_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d inertia_m5_ = Eigen::Matrix3d::Zero();
};

}  // namespace soft_robot_lab
