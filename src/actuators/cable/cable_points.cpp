#include "actuators/cable/cable_points.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <Eigen/Geometry>

namespace soft_robot_lab {
namespace {

constexpr double kNear_m = 1e-9;

struct Spread {
  double sheath_radius_m, plug_radius_m;
  double box_m;  // of every point; 0 for discs
};

std::string triple(const Eigen::Vector3d& v) {
  std::ostringstream text;
  text << "(" << v.x() << ", " << v.y() << ", " << v.z() << ") m";
  return text.str();
}

std::vector<Eigen::Vector3d> read_path(const SettingsNode& settings) {
  std::vector<Eigen::Vector3d> path;
  for (const SettingsNode& item : settings.sequence("points_m")) {
    const Eigen::VectorXd point = item.as_numbers();
    if (point.size() != 3) item.fail("a point is [x, y, z] in m");
    path.emplace_back(point);
    if (path.size() > 1 && (path.back() - path[path.size() - 2]).norm() < kNear_m)
      item.fail("repeats the point before it, " + triple(path.back()));
  }
  if (path.size() < 2)
    settings.fail("points_m: a cable needs at least two points, this one has " + std::to_string(path.size()));
  return path;
}

bool held(const EmbeddedPoint& point, const FixedAxes& fixed) {
  for (std::size_t k = 0; k < point.nodes.size(); ++k)
    if (std::abs(point.weights[k]) > 1e-9 && !fixed.col(point.nodes[k]).all()) return false;
  return true;
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

void require_room(const SettingsNode& settings, const Eigen::Vector3d& plug_m, const Eigen::Vector3d& along,
                  double plug_radius_m, const MeshLocator& locator) {
  if (plug_radius_m == 0.0) return;
  const double width = width_m(plug_m, along, 2.0 * plug_radius_m, locator);
  if (2.0 * plug_radius_m <= width) return;
  std::ostringstream message;
  message << "plug_radius_m: " << plug_radius_m << " is out of range [0, " << 0.5 * width
          << "]: the plug would be wider than the body, which is about " << width << " m wide at " << triple(plug_m);
  settings.fail(message.str());
}

}  // namespace

CablePoints read_cable_points(const SettingsNode& settings, const Body& body, const MeshLocator& locator) {
  Spread spread{};
  spread.sheath_radius_m = settings.number_or("sheath_radius_m", 0.001, AllowedRange::not_negative());
  spread.plug_radius_m = settings.number_or("plug_radius_m", 0.003, AllowedRange::not_negative());
  spread.box_m = settings.number_or("spread_box_m", 0.0, AllowedRange::not_negative());
  const double reach = std::max(spread.sheath_radius_m, 0.5 * spread.box_m) + kNear_m;
  const std::vector<Eigen::Vector3d> path = read_path(settings);
  const std::vector<SettingsNode> items = settings.sequence("points_m");
  CablePoints result;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Location location = locator.locate(path[i]);
    if (location.distance_m > reach) {
      std::ostringstream message;
      message << "point " << i << " at " << triple(path[i]) << " lies " << location.distance_m
              << " m outside the body; the most is the sheath's radius, " << reach
              << " m; the nearest point of the body is " << triple(location.nearest_m);
      items[i].fail(message.str());
    }
    if (location.distance_m > kNear_m) result.changes.push_back({static_cast<int>(i), location.distance_m});
    const bool last = i + 1 == path.size();
    const Eigen::Vector3d along = path[last ? i : i + 1] - path[i == 0 ? i : i - 1];
    const EmbeddedPoint point = locator.embed(location);
    if (held(point, body.fixed())) {
      result.points.push_back(point);
    } else if (spread.box_m > 0.0) {
      result.points.push_back(locator.embed_box(location.nearest_m, spread.box_m));
    } else {
      if (last) require_room(settings, location.nearest_m, along, spread.plug_radius_m, locator);
      result.points.push_back(
          locator.embed_disc(location.nearest_m, along, last ? spread.plug_radius_m : spread.sheath_radius_m));
    }
  }
  return result;
}

}  // namespace soft_robot_lab
