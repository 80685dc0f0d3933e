// SPDX-License-Identifier: BSD-3-Clause
#include "cable_points.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <Eigen/Geometry>

#include "cable_route.h"
#include "mechanics/body/held.h"
#include "settings/point_text.h"
#include "settings/read_points.h"

namespace soft_robot_lab {
namespace {

constexpr double kRound = 1e-6;         // of the body's size: the same of a sheath without a radius
constexpr double kFarthestShift = 0.5;  // of a disc's radius
constexpr double kOnSkin = 0.1;         // of the sheath's radius: nearer to the skin counts as on it

struct Spread {
  double sheath_radius_m, plug_radius_m;
  double box_m;  // of every point; 0 for discs
};

// Only silicone bends a cable: the points of a curve between which it is in the air are none of its own.
void leave_out_air(const MeshLocator& locator, double tolerance_m, GivenPath& path) {
  const auto in_air = [&](const Eigen::Vector3d& at_m) { return locator.locate(at_m).distance_m > tolerance_m; };
  path.erase(std::remove_if(path.begin() + 1, path.end() - 1, in_air), path.end() - 1);
}

std::vector<PathPoint> path_points(const YamlNode& settings, const Body& body, const MeshLocator& locator,
                                   double sheath_radius_m) {
  CablePath path = read_cable_path(settings);
  const bool per_element = settings.choice_or("via_points", path.routes_itself() ? "per_element" : "given",
                                              {"given", "per_element"}) == "per_element";
  if (path.routes_itself()) {
    const double tolerance_m = std::max(kOnSkin * sheath_radius_m, kRound * body.size_m());
    if (path.key == "spline_m") leave_out_air(locator, tolerance_m, path.points_m);
    return routed(path, body.mesh(), locator, {tolerance_m, per_element}, settings);
  }
  return per_element ? with_point_per_element(path.points_m, body.mesh(), locator) : as_given(path.points_m);
}

// Points on the frame, each carried by a held node of its own, the nearest ones to the first point in the silicone: so
// a point stays where it is, and goes along with a hold that moves.
std::vector<EmbeddedPoint> read_drive_points(const YamlNode& settings, const Body& body,
                                             const Eigen::Vector3d& first_m) {
  std::vector<EmbeddedPoint> points;
  if (!settings.has("drive_points_m")) return points;
  const Eigen::Matrix3Xd& nodes_m = body.mesh().nodes_m;
  std::vector<int> held_nodes;
  for (int node = 0; node < nodes_m.cols(); ++node)
    if (body.fixed().col(node).all()) held_nodes.push_back(node);
  const auto distance_m = [&](int node) { return (nodes_m.col(node) - first_m).norm(); };
  std::stable_sort(held_nodes.begin(), held_nodes.end(), [&](int a, int b) { return distance_m(a) < distance_m(b); });
  const std::vector<YamlNode> items = settings.sequence("drive_points_m");
  const std::vector<Eigen::Vector3d> places_m = read_points(settings, "drive_points_m");
  if (!places_m.empty() && (places_m.front() - first_m).norm() < kNear_m)
    items.front().fail("repeats the point beside it, " + point_text(first_m));
  if (places_m.size() > held_nodes.size())
    items[held_nodes.size()].fail("stands on the frame, which has no more than " + std::to_string(held_nodes.size()) +
                                  " nodes of body.fixed with all axes to carry it");
  for (const Eigen::Vector3d& at_m : places_m) {
    const int node = held_nodes[points.size()];
    points.push_back({{node}, {1.0}, at_m - nodes_m.col(node)});
  }
  return points;
}

// How wide the body is across a cable at its plug, in the direction in which it is least wide, seen no farther than
// `reach_m`.
double width_m(const Eigen::Vector3d& plug_m, const Eigen::Vector3d& along, double reach_m,
               const MeshLocator& locator) {
  constexpr int kSteps = 20, kDirections = 6;
  const Eigen::Vector3d u = along.unitOrthogonal(), v = along.normalized().cross(u);
  std::vector<double> least(kDirections, 0.0), most(kDirections, 0.0);
  for (int i = -kSteps; i <= kSteps; ++i) {
    for (int j = -kSteps; j <= kSteps; ++j) {
      const double x = reach_m * i / kSteps, y = reach_m * j / kSteps;
      if (locator.locate(plug_m + x * u + y * v).distance_m > kNear_m) continue;
      for (int d = 0; d < kDirections; ++d) {
        const double at = x * std::cos(M_PI * d / kDirections) + y * std::sin(M_PI * d / kDirections);
        least[d] = std::min(least[d], at);
        most[d] = std::max(most[d], at);
      }
    }
  }
  double width = 2.0 * reach_m;
  for (int d = 0; d < kDirections; ++d) width = std::min(width, most[d] - least[d]);
  return width + reach_m / kSteps;  // it may end anywhere up to the next sample
}

void require_room(const YamlNode& settings, const Eigen::Vector3d& plug_m, const Eigen::Vector3d& along,
                  double plug_radius_m, const MeshLocator& locator) {
  if (plug_radius_m == 0.0) return;
  const double width = width_m(plug_m, along, 2.0 * plug_radius_m, locator);
  if (2.0 * plug_radius_m <= width) return;
  std::ostringstream message;
  message << "plug_radius_m: " << plug_radius_m << " is out of range [0, " << 0.5 * width
          << "]: the plug would be wider than the body, which is about " << width << " m wide at "
          << point_text(plug_m);
  settings.fail(message.str());
}

void require_near(const YamlNode& settings, const PathPoint& point, const Location& location, double reach_m) {
  if (location.distance_m <= reach_m) return;
  std::ostringstream message;
  message << "point " << point.given << " at " << point_text(point.position_m) << " lies " << location.distance_m
          << " m outside the body; the most is the sheath's radius, " << reach_m
          << " m; the nearest point of the body is " << point_text(location.nearest_m);
  place_of(static_cast<std::size_t>(point.given), read_cable_path(settings), settings).fail(message.str());
}

// Samples of a disc that lie outside the body are left out, and the point moves to the middle of the others.
void require_mostly_inside(const YamlNode& settings, const PathPoint& point, double shift_m, double radius_m) {
  if (shift_m <= kFarthestShift * radius_m + kNear_m) return;
  std::ostringstream message;
  message << "point " << point.given << " at " << point_text(point.position_m) << ": its disc of radius " << radius_m
          << " m lies so far outside the body that it takes hold " << shift_m
          << " m beside it; the most is half the radius; move it inwards, or give a smaller sheath_radius_m or "
             "plug_radius_m";
  settings.fail(message.str());
}

}  // namespace

CablePoints read_cable_points(const YamlNode& settings, const Body& body, const MeshLocator& locator) {
  Spread spread{};
  spread.sheath_radius_m = settings.number_or("sheath_radius_m", 0.001, AllowedRange::not_negative());
  spread.plug_radius_m = settings.number_or("plug_radius_m", 0.003, AllowedRange::not_negative());
  spread.box_m = settings.number_or("spread_box_m", 0.0, AllowedRange::not_negative());
  const double reach = std::max(spread.sheath_radius_m, 0.5 * spread.box_m) + kNear_m;
  const std::vector<PathPoint> path = path_points(settings, body, locator, spread.sheath_radius_m);
  CablePoints result;
  result.points = read_drive_points(settings, body, path.front().position_m);
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Location location = locator.locate(path[i].position_m);
    if (path[i].given >= 0) require_near(settings, path[i], location, reach);
    const bool last = i + 1 == path.size();
    const Eigen::Vector3d before_m = i > 0  ? path[i - 1].position_m
                                     : last ? result.points.back().at(body.mesh().nodes_m)
                                            : path[i].position_m;
    const Eigen::Vector3d along = path[last ? i : i + 1].position_m - before_m;
    const EmbeddedPoint point = locator.embed(location);
    if (held(point, body.fixed())) {
      result.points.push_back(point);
    } else if (spread.box_m > 0.0) {
      result.points.push_back(locator.embed_box(location.nearest_m, spread.box_m));
    } else {
      if (last) require_room(settings, location.nearest_m, along, spread.plug_radius_m, locator);
      const double radius_m = last ? spread.plug_radius_m : spread.sheath_radius_m;
      result.points.push_back(locator.embed_disc(location.nearest_m, path[i].normal.value_or(along), radius_m));
      const Eigen::Vector3d there_m = result.points.back().at(body.mesh().nodes_m);
      require_mostly_inside(settings, path[i], (there_m - location.nearest_m).norm(), radius_m);
    }
    const double moved_m = (result.points.back().at(body.mesh().nodes_m) - path[i].position_m).norm();
    if (moved_m > kNear_m) result.changes.push_back({path[i].given, moved_m});
  }
  return result;
}

}  // namespace soft_robot_lab
