// SPDX-License-Identifier: BSD-3-Clause
#include "thickness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>

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

// Which smooth part of the skin each triangle belongs to, and which of these meet at an edge.
class Patches {
 public:
  explicit Patches(const Surface& surface) : patch_(static_cast<size_t>(surface.triangle_count()), -1) {
    int count = 0;
    for (int t = 0; t < surface.triangle_count(); ++t)
      if (patch_[static_cast<size_t>(t)] < 0) spread(surface, t, count++);
    for (int t = 0; t < surface.triangle_count(); ++t)
      for (const int other : surface.neighbours.col(t)) meet_.insert({of(t), of(other)});
  }

  bool meet(int a, int b) const { return meet_.count({of(a), of(b)}) > 0; }

 private:
  int of(int triangle) const { return patch_[static_cast<size_t>(triangle)]; }

  void spread(const Surface& surface, int seed, int name) {
    constexpr double kSmooth = 0.87;  // cosine of 30 degrees
    std::vector<int> open{seed};
    patch_[static_cast<size_t>(seed)] = name;
    while (!open.empty()) {
      const int t = open.back();
      open.pop_back();
      for (const int next : surface.neighbours.col(t)) {
        if (of(next) >= 0 || surface.normals.col(t).dot(surface.normals.col(next)) < kSmooth) continue;
        patch_[static_cast<size_t>(next)] = name;
        open.push_back(next);
      }
    }
  }

  std::vector<int> patch_;
  std::set<std::pair<int, int>> meet_;
};

// The skin that paths inside a ball lead to, one start after the other.
class Flood {
 public:
  explicit Flood(const Surface& surface) : surface_(surface), seen_(static_cast<size_t>(surface.triangle_count()), 0) {}

  void from(int triangle, const Eigen::Vector3d& around_m, double radius_m) {
    ++round_;
    open_ = {triangle};
    seen_[static_cast<size_t>(triangle)] = round_;
    while (!open_.empty()) {
      const int t = open_.back();
      open_.pop_back();
      for (int e = 0; e < 3; ++e) {
        const int next = surface_.neighbours(e, t);
        if (reached(next) || edge_distance_m(surface_, t, e, around_m) >= radius_m) continue;
        seen_[static_cast<size_t>(next)] = round_;
        open_.push_back(next);
      }
    }
  }

  bool reached(int triangle) const { return seen_[static_cast<size_t>(triangle)] == round_; }

 private:
  const Surface& surface_;
  std::vector<int> seen_;
  std::vector<int> open_;
  int round_ = 0;
};

bool runs_inside(const RayTree& tree, const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
  const Eigen::Vector3d way = q - p;
  const auto hit = tree.first_hit(p, way.normalized(), tree.skip_m());
  return !hit || hit->distance_m >= way.norm() - 2 * tree.skip_m();
}

struct Opposite {
  int triangle;
  double distance_m;
  Eigen::Vector3d at_m;
};

// Skin within the limit that faces away from p, seen from inside, and that no path on the skin leads to.
std::vector<Opposite> opposite_skin(const RayTree& tree, const Flood& joined, const Eigen::Vector3d& p,
                                    const Eigen::Vector3d& normal, double limit_m) {
  const Surface& surface = tree.surface();
  const double small = tree.skip_m(), largest = limit_m * (1 - 1e-6);
  std::vector<Opposite> found;
  tree.near(p, limit_m, [&](int t) {
    // Of any point of its plane alike, so that most are left out before the nearest is looked for.
    if (joined.reached(t) || (surface.corner(t, 0) - p).dot(surface.normals.col(t)) <= small) return;
    const Eigen::Vector3d q = nearest_point(surface, t, p), way = q - p;
    const double distance = way.norm();
    if (distance < largest && way.dot(normal) < -small) found.push_back({t, distance, q});
  });
  return found;
}

// Places that the cone of one triangle's points meets from inside, nearest first. Samples of one cell of space that
// face about the same way share the answer of the first: round sides have far more facets than the limit asks for.
class Cone {
 public:
  Cone(const RayTree& tree, double limit_m)
      : tree_(tree), limit_m_(limit_m), patches_(tree.surface()), flood_(tree.surface()) {}

  void measure(int triangle, const Eigen::Vector3d& p, double area, ThinPlace& place) {
    const auto [answer, first] = thin_.try_emplace(cell(p, tree_.surface().normals.col(triangle)), false);
    if (first)
      answer->second = look(triangle, p, area, place);
    else if (answer->second)
      place.area_m2 += area;
  }

 private:
  using Cell = std::array<long, 4>;

  Cell cell(const Eigen::Vector3d& p, const Eigen::Vector3d& normal) const {
    Eigen::Index axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    const Eigen::Vector3d place = 8 / limit_m_ * p;
    return {std::lround(place.x()), std::lround(place.y()), std::lround(place.z()), 2 * axis + (normal[axis] > 0)};
  }

  // Whether it is thin there.
  bool look(int triangle, const Eigen::Vector3d& p, double area, ThinPlace& place) {
    flood_.from(triangle, p, limit_m_);
    std::vector<Opposite> found = opposite_skin(tree_, flood_, p, tree_.surface().normals.col(triangle), limit_m_);
    const auto nearer = [](const Opposite& a, const Opposite& b) {
      return std::tie(a.distance_m, a.triangle) < std::tie(b.distance_m, b.triangle);
    };
    std::sort(found.begin(), found.end(), nearer);
    for (const Opposite& other : found)
      if (!is_corner(triangle, other.triangle) && runs_inside(tree_, p, other.at_m)) {
        keep(place, other.distance_m, p, other.at_m, area, limit_m_);
        return true;
      }
    return false;
  }

  // Adjacent surfaces make no back side, unless they are those of a knife's edge.
  bool is_corner(int a, int b) const {
    const Surface& surface = tree_.surface();
    return surface.normals.col(a).dot(surface.normals.col(b)) > -std::cos(2 * kHalfCone) && patches_.meet(a, b);
  }

  const RayTree& tree_;
  double limit_m_;
  Patches patches_;
  Flood flood_;
  std::map<Cell, bool> thin_;
};

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
  Cone cone(tree, limit_m);
  result.of_facets.assign(static_cast<size_t>(tree.surface().triangle_count()), kInfinite);
  sample_skin(tree.surface(), limit_m / 4, [&](int t, const Eigen::Vector3d& p, double area) {
    const Ball ball = largest_ball(tree, p, tree.surface().true_normals.col(t));
    double& least = result.of_facets[static_cast<size_t>(t)];
    least = std::min(least, ball.diameter_m);
    keep(result.ball, ball.diameter_m, p, ball.touch_m, area, limit_m);
    cone.measure(t, p, area, result.cone);
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
