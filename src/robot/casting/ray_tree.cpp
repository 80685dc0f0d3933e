// SPDX-License-Identifier: BSD-3-Clause
#include "ray_tree.h"

#include <algorithm>
#include <cmath>

#include "mechanics/mesh/nearest_on_triangle.h"

namespace soft_robot_lab {

RayTree::RayTree(const Surface& surface)
    : surface_(surface),
      size_m_(surface.size_m()),
      skip_m_(2e-6 * size_m_),
      tree_(surface.vertices_m, surface.triangles, MeshTree::Use::still) {}

std::optional<SurfaceHit> RayTree::first_hit(const Eigen::Vector3d& origin_m, const Eigen::Vector3d& direction,
                                             double near_m) const {
  const MeshHit hit = tree_.cast(origin_m.cast<float>(), direction.cast<float>(), static_cast<float>(near_m));
  if (hit.triangle < 0) return std::nullopt;
  const Eigen::Vector3d normal = surface_.normals.col(hit.triangle);
  const double slope = normal.dot(direction);
  const double exact = normal.dot(surface_.corner(hit.triangle, 0) - origin_m) / slope;
  const bool usable = std::abs(slope) > 1e-3;
  return SurfaceHit{hit.triangle, usable ? exact : static_cast<double>(hit.depth)};
}

void RayTree::near(const Eigen::Vector3d& point_m, double radius_m, const std::function<void(int)>& visit) const {
  tree_.visit_near(point_m.cast<float>(), static_cast<float>(radius_m), visit);
}

namespace {

// Its ends lie on both sides, by more than rounding: beside a sliver an edge may seem to meet what it does not.
bool passes_through(const Surface& surface, int triangle, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                    double least_m) {
  const Eigen::Vector3d normal = surface.normals.col(triangle), corner = surface.corner(triangle, 0);
  const double before = normal.dot(from - corner), behind = normal.dot(to - corner);
  return before * behind < 0 && std::min(std::abs(before), std::abs(behind)) > least_m;
}

}  // namespace

std::optional<Eigen::Vector3d> find_crossing(const RayTree& tree) {
  const Surface& surface = tree.surface();
  for (int t = 0; t < surface.triangle_count(); ++t) {
    for (int e = 0; e < 3; ++e) {
      if (surface.neighbours(e, t) < t) continue;  // its other triangle has been there
      const int from = surface.triangles(e, t), to = surface.triangles((e + 1) % 3, t);
      const Eigen::Vector3d start = surface.vertices_m.col(from), way = surface.vertices_m.col(to) - start;
      const double length = way.norm();
      if (length == 0) continue;
      double beyond = tree.skip_m();
      while (const auto hit = tree.first_hit(start, way / length, beyond)) {
        if (hit->distance_m > length - tree.skip_m()) break;
        const auto corners = surface.triangles.col(hit->triangle);
        if ((corners.array() != from).all() && (corners.array() != to).all() &&
            passes_through(surface, hit->triangle, start, start + way, tree.skip_m()))
          return start + hit->distance_m / length * way;
        beyond = std::max(beyond, hit->distance_m) + tree.skip_m();
      }
    }
  }
  return std::nullopt;
}

Eigen::Vector3d nearest_point(const Surface& surface, int triangle, const Eigen::Vector3d& point_m) {
  return nearest_on_triangle(point_m, surface.vertices_m(Eigen::all, surface.triangles.col(triangle))).at_m;
}

}  // namespace soft_robot_lab
