// SPDX-License-Identifier: BSD-3-Clause
// Which of many triangles is nearest to a point: a tree of boxes, halved along their longest sides.
#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "closed_surface.h"

namespace soft_robot_lab {

struct NearestTriangle {
  Eigen::Index triangle = -1;
  NearestOnTriangle place;
  double distance_m = 0.0;
};

class TriangleTree {
 public:
  explicit TriangleTree(const ClosedSurface& surface);

  NearestTriangle nearest(const ClosedSurface& surface, const Eigen::Vector3d& point_m) const;

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    int first = 0, count = 0;  // of the order; inner nodes have none
    int left = -1, right = -1;
  };
  int build(const std::vector<Eigen::AlignedBox3d>& boxes, int first, int count);
  void search(const ClosedSurface& surface, int node, const Eigen::Vector3d& point_m, NearestTriangle& best) const;

  std::vector<int> order_;  // triangles with an area
  std::vector<Node> nodes_;
};

}  // namespace soft_robot_lab
