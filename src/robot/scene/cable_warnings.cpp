// SPDX-License-Identifier: BSD-3-Clause
#include "cable_warnings.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>

#include "mechanics/mesh/cable_path.h"
#include "mechanics/body/held.h"
#include "mechanics/mesh/skin.h"
#include "scene_warning.h"
#include "settings/point_text.h"
#include "settings/read_name.h"

namespace soft_robot_lab {
namespace {

constexpr double kLongestSpan = 3.0;   // times an element's edge
constexpr int kSamples = 16;           // along a span
constexpr double kOnSkin = 0.1;        // of the plug's radius
constexpr double kFarFromClamp = 3.0;  // elements' edges

// Of a regular element of the mean volume.
double mean_edge_m(const TetMesh& mesh) { return std::cbrt(6.0 * std::sqrt(2.0) * volume(mesh) / mesh.tet_count()); }

bool in_silicone(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m, const MeshLocator& locator) {
  for (int i = 0; i < kSamples; ++i)
    if (locator.locate(from_m + (i + 0.5) / kSamples * (to_m - from_m)).distance_m > 1e-9) return false;
  return true;
}

std::optional<SolveWarning> straight_span(const YamlNode& cable, const CablePath& path, const TetMesh& mesh,
                                          const MeshLocator& locator) {
  if (path.routes_itself() || cable.has("via_points")) return std::nullopt;
  const std::vector<Eigen::Vector3d>& path_m = path.points_m;
  const double longest_m = kLongestSpan * mean_edge_m(mesh);
  std::size_t worst = 0;
  double worst_m = longest_m;
  for (std::size_t i = 0; i + 1 < path_m.size(); ++i) {
    const double length_m = (path_m[i + 1] - path_m[i]).norm();
    if (length_m <= worst_m || !in_silicone(path_m[i], path_m[i + 1], locator)) continue;
    worst = i;
    worst_m = length_m;
  }
  if (worst_m <= longest_m) return std::nullopt;
  std::ostringstream text;
  text << "cable " << read_name(cable) << " is straight for " << 1e3 * worst_m << " mm of silicone after its point "
       << worst << ", however the body bends there: set `via_points: per_element`, or `given` where it is meant so";
  return scene_warning("straight_in_silicone", text.str(), worst_m, "m");
}

// A held plug moves with what holds it.
std::optional<SolveWarning> plug_on_skin(const YamlNode& cable, const CablePath& path, const Body& body,
                                         const MeshLocator& locator) {
  if (!path.routes_itself()) return std::nullopt;
  const Eigen::Vector3d& plug_m = path.points_m.back();
  const double radius_m = cable.number_or("plug_radius_m", 0.003, AllowedRange::not_negative());
  const SkinPoint skin = nearest_on_skin(body.mesh(), plug_m);
  if (skin.distance_m > kOnSkin * radius_m) return std::nullopt;
  if (held(locator.embed(locator.locate(plug_m)), body.fixed())) return std::nullopt;
  std::ostringstream text;
  text << "the plug of cable " << read_name(cable) << " lies on the skin at " << point_text(plug_m)
       << ", where silicone snaps over it: end the path at least plug_radius_m, " << radius_m << " m, inside the body";
  return scene_warning("plug_on_skin", text.str(), skin.distance_m, "m");
}

double to_held_m(const Eigen::Vector3d& point_m, const Body& body) {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const Hold& hold : body.holds())
    for (const int node : hold.nodes) nearest_m = std::min(nearest_m, (body.mesh().nodes_m.col(node) - point_m).norm());
  return nearest_m;
}

// The drive stands at the clamp, unless `drive_points_m` says where else.
std::optional<SolveWarning> back_to_front(const YamlNode& cable, const CablePath& path, const Body& body) {
  if (body.holds().empty() || cable.has("drive_points_m")) return std::nullopt;
  const double edge_m = mean_edge_m(body.mesh()), first_m = to_held_m(path.points_m.front(), body);
  if (first_m <= kFarFromClamp * edge_m || to_held_m(path.points_m.back(), body) > edge_m) return std::nullopt;
  std::ostringstream text;
  text << "cable " << read_name(cable) << " ends at " << point_text(path.points_m.back())
       << ", where the body is held, and starts " << first_m << " m away from it: " << path.key
       << " goes from the drive, at the clamp, to the plug; turn its order round, or state the drive in drive_points_m";
  return scene_warning("cable_back_to_front", text.str(), first_m, "m");
}

}  // namespace

std::vector<SolveWarning> cable_warnings(const YamlNode& scene, const Body& body, const MeshLocator& locator) {
  std::vector<SolveWarning> warnings;
  for (const YamlNode& cable : scene.optional_sequence("cables")) {
    const CablePath path = read_cable_path(cable);
    for (const auto& warning : {straight_span(cable, path, body.mesh(), locator),
                                plug_on_skin(cable, path, body, locator), back_to_front(cable, path, body)})
      if (warning) warnings.push_back(*warning);
  }
  return warnings;
}

}  // namespace soft_robot_lab
