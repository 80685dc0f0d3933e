// SPDX-License-Identifier: BSD-3-Clause
#include "cable_route.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "mechanics/mesh/element_crossings.h"
#include "settings/point_text.h"

namespace soft_robot_lab {
namespace {

constexpr double kInside = 1e-6;        // in an element, off its faces, in reference coordinates
constexpr double kLongestGraze = 20.0;  // over the tolerance
constexpr int kSamples = 9;             // of a stretch's depth

struct Leg {
  Eigen::Vector3d from_m, to_m;

  Eigen::Vector3d at(double share) const { return from_m + share * (to_m - from_m); }
  double length_m() const { return (to_m - from_m).norm(); }
};

// A part of a leg, all in the silicone or all out of it.
struct Stretch {
  double from, to;
  bool inside;
  Eigen::Vector3d normal;  // of the skin where it begins
};

// Elements with a given via point inside, so that they need no other.
std::set<int> taken_elements(const GivenPath& path, const MeshLocator& locator) {
  std::set<int> taken;
  for (std::size_t i = 1; i + 1 < path.size(); ++i) {
    const Location at = locator.locate(path[i]);
    if (at.distance_m == 0.0 && at.local.minCoeff() > kInside && at.local.sum() < 1.0 - kInside) taken.insert(at.tet);
  }
  return taken;
}

// Shares of a leg at which it is in the middle of an element that is not taken yet.
std::vector<double> middles(const Leg& leg, const TetMesh& mesh, const MeshLocator& locator, std::set<int>& taken) {
  std::vector<double> shares;
  for (const ElementCrossing& crossing : element_crossings(mesh, leg.from_m, leg.to_m)) {
    const double middle = 0.5 * (crossing.from + crossing.to);
    if (taken.insert(crossing.tet).second && locator.locate(leg.at(middle)).distance_m <= kNear_m)
      shares.push_back(middle);
  }
  return shares;
}

std::vector<Stretch> joined(const std::vector<Stretch>& parts) {
  std::vector<Stretch> stretches;
  for (const Stretch& part : parts) {
    if (!stretches.empty() && stretches.back().inside == part.inside) {
      stretches.back().to = part.to;
    } else {
      stretches.push_back(part);
    }
  }
  return stretches;
}

std::vector<Stretch> stretches_of(const Leg& leg, const TetMesh& mesh, const MeshLocator& locator) {
  std::vector<SkinCrossing> cuts = skin_crossings(mesh, leg.from_m, leg.to_m);
  cuts.push_back({1.0, Eigen::Vector3d::Zero()});
  std::vector<Stretch> parts;
  SkinCrossing from{0.0, Eigen::Vector3d::Zero()};
  for (const SkinCrossing& cut : cuts) {
    if ((cut.share - from.share) * leg.length_m() <= kNear_m) continue;
    const Eigen::Vector3d middle_m = leg.at(0.5 * (from.share + cut.share));
    parts.push_back({from.share, cut.share, locator.locate(middle_m).distance_m <= kNear_m, from.normal});
    from = cut;
  }
  return joined(parts);
}

// How far from the skin it comes, in the silicone or out of it.
double farthest_m(const Leg& leg, const Stretch& stretch, const TetMesh& mesh) {
  double farthest = 0.0;
  for (int i = 0; i < kSamples; ++i)
    farthest = std::max(
        farthest,
        nearest_on_skin(mesh, leg.at(stretch.from + (i + 0.5) / kSamples * (stretch.to - stretch.from))).distance_m);
  return farthest;
}

[[noreturn]] void refuse_along_skin(const Leg& leg, const Stretch& stretch, double tolerance_m, const YamlNode& item) {
  std::ostringstream text;
  text << "on the way to this point the path runs along the skin, within " << tolerance_m << " m of it, from "
       << point_text(leg.at(stretch.from)) << " to " << point_text(leg.at(stretch.to))
       << ": it is neither in a sheath nor free there; lead it deeper or farther out, or set its points with points_m";
  item.fail(text.str());
}

std::vector<Stretch> without_grazes(const Leg& leg, std::vector<Stretch> stretches, const TetMesh& mesh,
                                    double tolerance_m, const YamlNode& item) {
  for (Stretch& stretch : stretches) {
    if (farthest_m(leg, stretch, mesh) >= tolerance_m) continue;
    if ((stretch.to - stretch.from) * leg.length_m() > kLongestGraze * tolerance_m)
      refuse_along_skin(leg, stretch, tolerance_m, item);
    stretch.inside = !stretch.inside;
  }
  return joined(stretches);
}

void refuse_air(const CablePath& cable, const MeshLocator& locator, double tolerance_m, const YamlNode& settings) {
  const GivenPath& path = cable.points_m;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Location at = locator.locate(path[i]);
    if (at.distance_m <= tolerance_m) continue;
    const bool end = i == 0 || i + 1 == path.size();
    std::ostringstream text;
    text << "point " << i << " at " << point_text(path[i]) << " lies " << at.distance_m
         << " m outside the body, where nothing "
         << (end ? "holds the cable's end" : "bends the cable: it is straight from where it leaves to where it enters")
         << "; the most is a tenth of the sheath's radius, " << tolerance_m << " m; the nearest point of the body is "
         << point_text(at.nearest_m);
    place_of(i, cable, settings).fail(text.str());
  }
}

// A sheath that begins or ends on the skin lies in it there, or a part of its disc would be in the air.
std::optional<Eigen::Vector3d> mouth_normal(const Eigen::Vector3d& at_m, const TetMesh& mesh, double tolerance_m) {
  const GripPlace place = grip_on_skin(mesh, mesh.nodes_m, at_m);
  if (place.distance_m > tolerance_m) return std::nullopt;
  return place.rest_normal;
}

}  // namespace

std::vector<PathPoint> as_given(const GivenPath& path) {
  std::vector<PathPoint> points;
  for (const Eigen::Vector3d& position_m : path) points.push_back({position_m, static_cast<int>(points.size())});
  return points;
}

std::vector<PathPoint> with_point_per_element(const GivenPath& path, const TetMesh& mesh, const MeshLocator& locator) {
  std::set<int> taken = taken_elements(path, locator);
  std::vector<PathPoint> points = {{path.front(), 0}};
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Leg leg{path[i - 1], path[i]};
    for (const double share : middles(leg, mesh, locator, taken)) points.push_back({leg.at(share), -1});
    points.push_back({path[i], static_cast<int>(i)});
  }
  return points;
}

std::vector<PathPoint> routed(const CablePath& cable, const TetMesh& mesh, const MeshLocator& locator,
                              const RouteRules& rules, const YamlNode& settings) {
  refuse_air(cable, locator, rules.tolerance_m, settings);
  const GivenPath& path = cable.points_m;
  std::set<int> taken = taken_elements(path, locator);
  std::vector<PathPoint> points = {{path.front(), 0, mouth_normal(path.front(), mesh, rules.tolerance_m)}};
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Leg leg{path[i - 1], path[i]};
    const std::vector<Stretch> stretches =
        without_grazes(leg, stretches_of(leg, mesh, locator), mesh, rules.tolerance_m, place_of(i, cable, settings));
    std::vector<std::pair<double, PathPoint>> set;
    const auto add = [&](double share, const std::optional<Eigen::Vector3d>& normal) {  // those set first stay
      const auto close = [&](double other) { return std::abs(share - other) * leg.length_m() < rules.tolerance_m; };
      if (close(0.0) || close(1.0)) return;
      if (std::any_of(set.begin(), set.end(), [&](const auto& other) { return close(other.first); })) return;
      set.push_back({share, {leg.at(share), -1, normal}});
    };
    for (std::size_t k = 1; k < stretches.size(); ++k) add(stretches[k].from, stretches[k].normal);
    if (rules.per_element)
      for (const double share : middles(leg, mesh, locator, taken)) add(share, std::nullopt);
    std::sort(set.begin(), set.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [share, point] : set) points.push_back(point);
    points.push_back({path[i], static_cast<int>(i)});
  }
  points.back().normal = mouth_normal(path.back(), mesh, rules.tolerance_m);
  return points;
}

}  // namespace soft_robot_lab
