// SPDX-License-Identifier: BSD-3-Clause
#include "thickness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <unordered_map>

#include <Eigen/Geometry>

#include "sample_triangle.h"

namespace soft_robot_lab {
namespace {

constexpr double kHalfCone =
    30 * M_PI / 180;  // of the rays: half of what is left of 180 when balls must see 120 degrees
constexpr double kMostSamples = 60000;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

// Of a cone around z: its axis and two rings.
const std::vector<Eigen::Vector3d>& cone_rays() {
  static const std::vector<Eigen::Vector3d> rays = [] {
    std::vector<Eigen::Vector3d> all{Eigen::Vector3d::UnitZ()};
    for (const auto& [tilt, count] : {std::pair{kHalfCone / 2, 6}, std::pair{0.97 * kHalfCone, 10}})
      for (int i = 0; i < count; ++i) {
        const double turn = 2 * M_PI * i / count;
        all.emplace_back(std::sin(tilt) * std::cos(turn), std::sin(tilt) * std::sin(turn), std::cos(tilt));
      }
    return all;
  }();
  return rays;
}

struct Ball {
  double diameter_m = kInfinite;
  Eigen::Vector3d touch_m = Eigen::Vector3d::Zero();
};

// Whether a ball that touches skin at p and q is seen from its centre under more than 120 degrees.
bool can_touch(const Eigen::Vector3d& m, const Eigen::Vector3d& normal) {
  return m.dot(normal) > std::cos(2 * kHalfCone) + 1e-9;
}

Ball largest_ball(const RayTree& tree, const Eigen::Vector3d& p, const Eigen::Vector3d& normal) {
  const Eigen::Vector3d m = -normal;
  const Eigen::Matrix3d frame = frame_along(m);
  Ball ball;
  for (const Eigen::Vector3d& ray : cone_rays()) {
    const Eigen::Vector3d direction = frame * ray;
    const auto hit = tree.first_hit(p, direction, tree.skip_m());
    if (!hit || !can_touch(m, tree.surface().normals.col(hit->triangle))) continue;
    const double diameter = hit->distance_m / ray.z();
    if (diameter < ball.diameter_m) ball = {diameter, p + hit->distance_m * direction};
  }
  return ball;
}

void keep(ThinPlace& place, double thickness_m, const Eigen::Vector3d& at, const Eigen::Vector3d& opposite, double area,
          double limit_m) {
  if (thickness_m < limit_m) place.area_m2 += area;
  if (thickness_m >= place.worst_m) return;
  place.worst_m = thickness_m;
  place.at_m = at;
  place.opposite_m = opposite;
}

// --- the source's cone ---

double edge_distance_m(const Surface& surface, int triangle, int edge, const Eigen::Vector3d& p) {
  const Eigen::Vector3d a = surface.corner(triangle, edge), along = surface.corner(triangle, (edge + 1) % 3) - a;
  const double share = std::clamp((p - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (a + share * along - p).norm();
}

// The triangles that a path on the skin inside the ball joins to the one that p lies on.
std::set<int> joined_to(const Surface& surface, int start, const Eigen::Vector3d& p, double radius_m) {
  std::set<int> joined{start};
  std::vector<int> open{start};
  while (!open.empty()) {
    const int t = open.back();
    open.pop_back();
    for (int e = 0; e < 3; ++e) {
      const int next = surface.neighbours(e, t);
      if (joined.count(next) > 0 || edge_distance_m(surface, t, e, p) >= radius_m) continue;
      joined.insert(next);
      open.push_back(next);
    }
  }
  return joined;
}

bool runs_inside(const RayTree& tree, const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
  const Eigen::Vector3d way = q - p;
  const auto hit = tree.first_hit(p, way.normalized(), tree.skip_m());
  return !hit || hit->distance_m >= way.norm() - 2 * tree.skip_m();
}

struct Opposite {
  int triangle;
  Eigen::Vector3d at_m;
};

std::vector<Opposite> opposite_skin(const RayTree& tree, const Eigen::Vector3d& p, const Eigen::Vector3d& normal,
                                    double limit_m) {
  const Surface& surface = tree.surface();
  std::vector<Opposite> found;
  tree.near(p, limit_m, [&](int t) {
    if (surface.areas_m2[t] <= 0) return;
    const Eigen::Vector3d q = nearest_point(surface, t, p), way = q - p;
    const double small = tree.skip_m();
    if (way.norm() >= limit_m * (1 - 1e-6) || way.dot(normal) >= -small || way.dot(surface.normals.col(t)) <= small)
      return;
    found.push_back({t, q});
  });
  return found;
}

void measure_cone(const RayTree& tree, int triangle, const Eigen::Vector3d& p, double area, double limit_m,
                  ThinPlace& place) {
  const Surface& surface = tree.surface();
  std::vector<Opposite> found = opposite_skin(tree, p, surface.normals.col(triangle), limit_m);
  if (found.empty()) return;
  const std::set<int> joined = joined_to(surface, triangle, p, limit_m);
  const Opposite* nearest = nullptr;
  for (const Opposite& other : found) {
    if (joined.count(other.triangle) > 0) continue;
    if (nearest != nullptr && (other.at_m - p).norm() >= (nearest->at_m - p).norm()) continue;
    if (runs_inside(tree, p, other.at_m)) nearest = &other;
  }
  if (nearest != nullptr) keep(place, (nearest->at_m - p).norm(), p, nearest->at_m, area, limit_m);
}

// Two triangles a square of spacing, which is wider where there would be too many samples.
template <typename Visit>
void sample_skin(const Surface& surface, double spacing_m, const Visit& visit) {
  spacing_m = std::max(spacing_m, std::sqrt(2 * surface.areas_m2.sum() / kMostSamples));
  for (int t = 0; t < surface.triangle_count(); ++t) {
    if (surface.areas_m2[t] <= 0) continue;
    const bool curved = surface.is_curved(t);  // only there the facet's normal is the solid's: at its centre
    sample_triangle(surface, t, curved ? kInfinite : spacing_m,
                    [&](const Eigen::Vector3d& p, double area) { visit(t, p, area); });
  }
}

}  // namespace

Thickness measure_thickness(const RayTree& tree, double limit_m) {
  Thickness result;
  result.of_facets.assign(static_cast<size_t>(tree.surface().triangle_count()), kInfinite);
  sample_skin(tree.surface(), limit_m / 4, [&](int t, const Eigen::Vector3d& p, double area) {
    const Ball ball = largest_ball(tree, p, tree.surface().true_normals.col(t));
    double& least = result.of_facets[static_cast<size_t>(t)];
    least = std::min(least, ball.diameter_m);
    keep(result.ball, ball.diameter_m, p, ball.touch_m, area, limit_m);
    measure_cone(tree, t, p, area, limit_m, result.cone);
  });
  return result;
}

ThinPlace measure_balls(const RayTree& tree, double limit_m) {
  ThinPlace place;
  sample_skin(tree.surface(), limit_m / 2, [&](int t, const Eigen::Vector3d& p, double area) {
    const Ball ball = largest_ball(tree, p, tree.surface().true_normals.col(t));
    keep(place, ball.diameter_m, p, ball.touch_m, area, limit_m);
  });
  return place;
}

}  // namespace soft_robot_lab
