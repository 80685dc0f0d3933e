// SPDX-License-Identifier: BSD-3-Clause
#include "check_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "mechanics/mesh/solid_angle.h"
#include "mechanics/mesh/tet_faces.h"
#include "settings/point_text.h"

namespace soft_robot_lab {
namespace {

constexpr size_t kMostCuts = 100000;
constexpr double kNoise = 1e-6;  // of the surface's size: what single precision makes of facets that meet

using Point = Eigen::Vector3d;
using Edge = std::pair<int, int>;

[[noreturn]] void refuse(const std::string& what) { throw std::invalid_argument(what); }

class Surface {
 public:
  Surface(const Eigen::Matrix3Xd& vertices_m, const Eigen::Matrix3Xi& facets) : vertices_(vertices_m) {
    for (Eigen::Index i = 0; i < facets.cols(); ++i) {
      const int a = facets(0, i), b = facets(1, i), c = facets(2, i);
      if (a != b && b != c && c != a) facets_.push_back({a, b, c});
    }
    if (facets_.empty()) refuse("holds no triangles");
    noise_m_ = kNoise * (vertices_.rowwise().maxCoeff() - vertices_.rowwise().minCoeff()).norm();
  }

  int count() const { return static_cast<int>(facets_.size()); }
  const FaceKey& facet(int i) const { return facets_[static_cast<size_t>(i)]; }
  Point vertex(int i) const { return vertices_.col(i); }
  Point corner(int i, int k) const { return vertices_.col(facet(i)[static_cast<size_t>(k)]); }
  Point centre(int i) const { return (corner(i, 0) + corner(i, 1) + corner(i, 2)) / 3; }
  Point middle(const Edge& edge) const { return (vertices_.col(edge.first) + vertices_.col(edge.second)) / 2; }
  double noise_m() const { return noise_m_; }
  Eigen::AlignedBox3d box(int i) const {
    Eigen::AlignedBox3d box(corner(i, 0));
    return box.extend(corner(i, 1)).extend(corner(i, 2));
  }
  int shared_corners(int i, int k) const {
    int shared = 0;
    for (const int a : facet(i))
      for (const int b : facet(k)) shared += a == b ? 1 : 0;
    return shared;
  }

 private:
  const Eigen::Matrix3Xd& vertices_;
  std::vector<FaceKey> facets_;
  double noise_m_;
};

void refuse_doubled(const Surface& surface) {
  std::map<FaceKey, int> first_of;
  int doubled = 0, first = -1;
  for (int i = 0; i < surface.count(); ++i) {
    const FaceKey& f = surface.facet(i);
    if (first_of.emplace(face_key(f[0], f[1], f[2]), i).second) continue;
    if (++doubled == 1) first = i;
  }
  if (doubled == 0) return;
  refuse((doubled == 1 ? std::string("a facet stands twice, at ")
                       : std::to_string(doubled) + " facets stand twice, the first at ") +
         point_text(surface.centre(first)) + "; leave out what stands twice");
}

struct EdgeUse {
  int facet, way;  // +1 where the facet goes from the lower to the higher vertex
};
using Edges = std::map<Edge, std::vector<EdgeUse>>;

Edges edges_of(const Surface& surface) {
  Edges edges;
  for (int i = 0; i < surface.count(); ++i)
    for (size_t k = 0; k < 3; ++k) {
      const int a = surface.facet(i)[k], b = surface.facet(i)[(k + 1) % 3];
      edges[std::minmax(a, b)].push_back({i, a < b ? 1 : -1});
    }
  return edges;
}

void refuse_open(const Surface& surface, const Edges& edges) {
  int open = 0, crowded = 0;
  Point first_open, first_crowded;
  for (const auto& [edge, uses] : edges) {
    if (uses.size() == 1 && ++open == 1) first_open = surface.middle(edge);
    if (uses.size() > 2 && ++crowded == 1) first_crowded = surface.middle(edge);
  }
  const auto more = [](int count) {
    return count > 1 ? "; " + std::to_string(count - 1) + " more edges are like that" : std::string();
  };
  if (open > 0)
    refuse("its surface is not closed: the edge at " + point_text(first_open) + " has one facet" + more(open) +
           "; fill its holes, or give a sheet a thickness");
  if (crowded > 0)
    refuse("its surface touches itself: the edge at " + point_text(first_crowded) + " has more than two facets" +
           more(crowded) + "; join what touches into one solid, or part it");
}

// Facets that hang together through edges.
struct Shell {
  std::vector<int> facets;
  bool consistent = true;  // all facets see the same side
  double volume_m3 = 0;
  Eigen::AlignedBox3d box;
};

double signed_volume(const Surface& surface, int i, const Point& from) {
  return (surface.corner(i, 0) - from).cross(surface.corner(i, 1) - from).dot(surface.corner(i, 2) - from) / 6;
}

std::vector<Shell> shells_of(const Surface& surface, const Edges& edges) {
  std::vector<std::vector<int>> beside(static_cast<size_t>(surface.count()));
  std::vector<bool> inconsistent(beside.size(), false), seen(beside.size(), false);
  for (const auto& [edge, uses] : edges) {
    beside[static_cast<size_t>(uses[0].facet)].push_back(uses[1].facet);
    beside[static_cast<size_t>(uses[1].facet)].push_back(uses[0].facet);
    if (uses[0].way == uses[1].way) inconsistent[static_cast<size_t>(uses[0].facet)] = true;
  }
  std::vector<Shell> shells;
  for (int first = 0; first < surface.count(); ++first) {
    if (seen[static_cast<size_t>(first)]) continue;
    Shell shell;
    shell.facets = {first};
    seen[static_cast<size_t>(first)] = true;
    for (size_t next = 0; next < shell.facets.size(); ++next) {
      const int i = shell.facets[next];
      shell.box.extend(surface.box(i));
      shell.volume_m3 += signed_volume(surface, i, surface.corner(first, 0));
      shell.consistent = shell.consistent && !inconsistent[static_cast<size_t>(i)];
      for (const int other : beside[static_cast<size_t>(i)])
        if (!seen[static_cast<size_t>(other)]) {
          seen[static_cast<size_t>(other)] = true;
          shell.facets.push_back(other);
        }
    }
    shells.push_back(std::move(shell));
  }
  return shells;
}

bool is_inside(const Surface& surface, const Point& point, const Shell& shell) {
  if (!shell.box.contains(point)) return false;
  double half = 0;
  for (const int i : shell.facets)
    half += half_solid_angle(surface.corner(i, 0) - point, surface.corner(i, 1) - point, surface.corner(i, 2) - point);
  return std::abs(half) > M_PI;
}

// One outer shell, and hollows in it that face the other way.
void refuse_parts(const Surface& surface, const std::vector<Shell>& shells) {
  if (shells.size() == 1) return;
  const auto outer = std::max_element(shells.begin(), shells.end(), [](const Shell& a, const Shell& b) {
    return a.box.diagonal().norm() < b.box.diagonal().norm();
  });
  const auto place = [&](const Shell& shell) { return point_text(surface.corner(shell.facets[0], 0)); };
  const std::string count = "its surface has " + std::to_string(shells.size()) + " shells: ";
  for (auto shell = shells.begin(); shell != shells.end(); ++shell) {
    if (shell == outer) continue;
    const Point point = surface.centre(shell->facets[0]);
    if (!is_inside(surface, point, *outer))
      refuse(count + "those at " + place(*outer) + " and " + place(*shell) +
             " lie apart, and a body must hang together; join them, or give each a file and an item of its own, in "
             "`bodies` or `obstacles`");
    for (const Shell& other : shells)
      if (&other != &*outer && &other != &*shell && is_inside(surface, point, other))
        refuse(count + "that at " + place(*shell) + " lies in a hollow, apart from the body");
    if (outer->consistent && shell->consistent && outer->volume_m3 * shell->volume_m3 > 0)
      refuse(count + "that at " + place(*shell) + " lies inside the body and faces outward as the body's own: a " +
             "hollow's facets face inward; turn them, or join what overlaps");
  }
}

Point normal_of(const Surface& surface, int i) {
  return (surface.corner(i, 1) - surface.corner(i, 0)).cross(surface.corner(i, 2) - surface.corner(i, 0));
}

// Where an edge of one facet passes through another, off its plane by more than the noise, and inside its edges by more
// than `inside_m`.
std::optional<Point> piercing(const Surface& surface, int of, int through, double inside_m) {
  const Point a = surface.corner(through, 0), area = normal_of(surface, through);
  if (area.norm() < surface.noise_m() * surface.noise_m()) return std::nullopt;
  const Point n = area.normalized();
  for (int k = 0; k < 3; ++k) {
    const Point p = surface.corner(of, k), q = surface.corner(of, (k + 1) % 3);
    const double hp = n.dot(p - a), hq = n.dot(q - a);
    if (hp * hq >= 0 || std::min(std::abs(hp), std::abs(hq)) < surface.noise_m()) continue;
    const Point at = p + hp / (hp - hq) * (q - p);
    bool inside = true;
    for (int side = 0; side < 3 && inside; ++side) {
      const Point from = surface.corner(through, side), along = surface.corner(through, (side + 1) % 3) - from;
      inside = n.dot(along.cross(at - from)) > inside_m * along.norm();
    }
    if (inside) return at;
  }
  return std::nullopt;
}

// Whether two facets of one plane lie on each other: no edge of either parts them.
std::optional<Point> overlap(const Surface& surface, int one, int other) {
  const Point area = normal_of(surface, one);
  if (area.norm() < surface.noise_m() * surface.noise_m()) return std::nullopt;
  const Point n = area.normalized();
  for (int k = 0; k < 3; ++k)
    if (std::abs(n.dot(surface.corner(other, k) - surface.corner(one, 0))) > surface.noise_m()) return std::nullopt;
  for (const auto& [facet, far] : {std::pair(one, other), std::pair(other, one)})
    for (int k = 0; k < 3; ++k) {
      const Point from = surface.corner(facet, k), along = surface.corner(facet, (k + 1) % 3) - from;
      const Point out = along.cross(n).normalized();
      const double own = out.dot(surface.corner(facet, (k + 2) % 3) - from);
      if (std::abs(own) < surface.noise_m()) return std::nullopt;  // a sliver
      double nearest = std::numeric_limits<double>::infinity();
      for (int i = 0; i < 3; ++i)
        nearest = std::min(nearest, -std::copysign(1.0, own) * out.dot(surface.corner(far, i) - from));
      if (nearest > -surface.noise_m()) return std::nullopt;
    }
  return (surface.centre(one) + surface.centre(other)) / 2;
}

struct Cut {
  int one, other;  // facets
  Point at;
  bool pierces;  // or lies on the other
};

std::optional<Cut> cut(const Surface& surface, int one, int other) {
  const int shared = surface.shared_corners(one, other);
  const double inside_m = shared == 0 ? -surface.noise_m() : surface.noise_m();  // facets of like grids meet in edges
  if (shared < 2)
    for (const auto& [of, through] : {std::pair(one, other), std::pair(other, one)})
      if (const std::optional<Point> at = piercing(surface, of, through, inside_m)) return Cut{one, other, *at, true};
  if (const std::optional<Point> at = overlap(surface, one, other)) return Cut{one, other, *at, false};
  return std::nullopt;
}

// Up to the most that are looked for. Sweeps along the axis on which facets are shortest.
std::vector<Cut> cuts_of(const Surface& surface) {
  std::vector<Eigen::AlignedBox3d> boxes;
  Eigen::AlignedBox3d all;
  Point lengths = Point::Zero();
  for (int i = 0; i < surface.count(); ++i) {
    boxes.push_back(surface.box(i));
    all.extend(boxes.back());
    lengths += boxes.back().sizes();
  }
  Eigen::Index axis = 0;
  lengths.cwiseQuotient(all.sizes().cwiseMax(surface.noise_m())).minCoeff(&axis);
  const auto box = [&](int i) -> const Eigen::AlignedBox3d& { return boxes[static_cast<size_t>(i)]; };
  std::vector<int> order(boxes.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return box(a).min()[axis] < box(b).min()[axis]; });
  std::vector<Cut> cuts;
  for (size_t i = 0; i < order.size() && cuts.size() < kMostCuts; ++i)
    for (size_t k = i + 1; k < order.size() && box(order[k]).min()[axis] <= box(order[i]).max()[axis]; ++k) {
      if (!box(order[i]).intersects(box(order[k]))) continue;
      if (const std::optional<Cut> found = cut(surface, order[i], order[k])) cuts.push_back(*found);
    }
  return cuts;
}

// A corner that was moved through a wall takes all its facets along, and what overlaps follows from that: the place is
// the cut nearest to the corner in which most cuts meet.
Point worst_of(const Surface& surface, std::vector<Cut> cuts) {
  if (std::any_of(cuts.begin(), cuts.end(), [](const Cut& cut) { return cut.pierces; }))
    cuts.erase(std::remove_if(cuts.begin(), cuts.end(), [](const Cut& cut) { return !cut.pierces; }), cuts.end());
  std::map<int, int> counts;
  for (const Cut& cut : cuts)
    for (const int facet : {cut.one, cut.other})
      for (const int vertex : surface.facet(facet)) ++counts[vertex];
  const Point corner = surface.vertex(
      std::max_element(counts.begin(), counts.end(), [](auto& a, auto& b) { return a.second < b.second; })->first);
  return std::min_element(cuts.begin(), cuts.end(),
                          [&](const Cut& a, const Cut& b) { return (a.at - corner).norm() < (b.at - corner).norm(); })
      ->at;
}

void refuse_cuts(const Surface& surface) {
  const std::vector<Cut> cuts = cuts_of(surface);
  if (!cuts.empty())
    refuse("its surface cuts itself near " + point_text(worst_of(surface, cuts)) +
           "; unite what overlaps into one surface");
}

}  // namespace

void check_surface(const Eigen::Matrix3Xd& vertices_m, const Eigen::Matrix3Xi& facets) {
  const Surface surface(vertices_m, facets);
  refuse_doubled(surface);
  const Edges edges = edges_of(surface);
  refuse_open(surface, edges);
  refuse_cuts(surface);
  refuse_parts(surface, shells_of(surface, edges));
}

}  // namespace soft_robot_lab
