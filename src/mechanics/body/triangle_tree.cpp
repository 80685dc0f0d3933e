// SPDX-License-Identifier: BSD-3-Clause
#include "triangle_tree.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace soft_robot_lab {
namespace {

constexpr int kLeaf = 4;

}  // namespace

TriangleTree::TriangleTree(const ClosedSurface& surface) {
  std::vector<Eigen::AlignedBox3d> boxes;
  for (Eigen::Index t = 0; t < surface.count(); ++t) {
    const Eigen::Matrix3d corners_m = surface.corners_m(t);
    boxes.emplace_back(corners_m.rowwise().minCoeff(), corners_m.rowwise().maxCoeff());
    if (surface.area_m2(t) > 0.0) order_.push_back(static_cast<int>(t));
  }
  build(boxes, 0, static_cast<int>(order_.size()));
}

int TriangleTree::build(const std::vector<Eigen::AlignedBox3d>& boxes, int first, int count) {
  const int index = static_cast<int>(nodes_.size());
  nodes_.emplace_back();
  const auto box = [&](int triangle) -> const Eigen::AlignedBox3d& {
    return boxes[static_cast<std::size_t>(triangle)];
  };
  const auto from = order_.begin() + first;
  Eigen::AlignedBox3d around;
  for (auto at = from; at != from + count; ++at) around.extend(box(*at));
  if (count <= kLeaf) {
    nodes_.back() = {around, first, count, -1, -1};
    return index;
  }
  Eigen::Index axis = 0;
  around.sizes().maxCoeff(&axis);
  const int half = count / 2;
  std::nth_element(from, from + half, from + count, [&](int a, int b) {
    return std::pair(box(a).center()[axis], a) < std::pair(box(b).center()[axis], b);
  });
  const int left = build(boxes, first, half), right = build(boxes, first + half, count - half);
  nodes_[static_cast<std::size_t>(index)] = {around, 0, 0, left, right};
  return index;
}

NearestTriangle TriangleTree::nearest(const ClosedSurface& surface, const Eigen::Vector3d& point_m) const {
  NearestTriangle best;
  best.distance_m = std::numeric_limits<double>::infinity();
  search(surface, 0, point_m, best);
  return best;
}

void TriangleTree::search(const ClosedSurface& surface, int node, const Eigen::Vector3d& point_m,
                          NearestTriangle& best) const {
  const Node& here = nodes_[static_cast<std::size_t>(node)];
  for (int i = here.first; i < here.first + here.count; ++i) {
    const int triangle = order_[static_cast<std::size_t>(i)];
    const NearestOnTriangle place = nearest_on_triangle(point_m, surface.corners_m(triangle));
    const double distance_m = (point_m - place.at_m).norm();
    if (distance_m < best.distance_m) best = {triangle, place, distance_m};
  }
  if (here.left < 0) return;
  const auto away_m = [&](int child) { return nodes_[static_cast<std::size_t>(child)].box.exteriorDistance(point_m); };
  std::pair nearer(away_m(here.left), here.left), farther(away_m(here.right), here.right);
  if (farther < nearer) std::swap(nearer, farther);
  for (const auto& [child_m, child] : {nearer, farther})
    if (child_m < best.distance_m) search(surface, child, point_m, best);
}

}  // namespace soft_robot_lab
