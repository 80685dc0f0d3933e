// SPDX-License-Identifier: BSD-3-Clause
#include "ray_tree.h"

#include <algorithm>
#include <cmath>

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
  const Eigen::Vector3d a = surface.corner(triangle, 0), b = surface.corner(triangle, 1),
                        c = surface.corner(triangle, 2), ab = b - a, ac = c - a;
  const double d1 = ab.dot(point_m - a), d2 = ac.dot(point_m - a), d3 = ab.dot(point_m - b), d4 = ac.dot(point_m - b),
               d5 = ab.dot(point_m - c), d6 = ac.dot(point_m - c);
  if (d1 <= 0 && d2 <= 0) return a;
  if (d3 >= 0 && d4 <= d3) return b;
  if (d6 >= 0 && d5 <= d6) return c;
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  return a + (vb * ab + vc * ac) / (va + vb + vc);
}

}  // namespace soft_robot_lab
