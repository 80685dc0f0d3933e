// SPDX-License-Identifier: BSD-3-Clause
#include "cable_warnings.h"

#include <cmath>
#include <sstream>

#include "mechanics/mesh/cable_path.h"
#include "settings/read_name.h"

namespace soft_robot_lab {
namespace {

constexpr double kLongestSpan = 3.0;  // times an element's edge
constexpr int kSamples = 16;          // along a span

// Of a regular element of the mean volume.
double mean_edge_m(const TetMesh& mesh) { return std::cbrt(6.0 * std::sqrt(2.0) * volume(mesh) / mesh.tet_count()); }

bool in_silicone(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m, const MeshLocator& locator) {
  for (int i = 0; i < kSamples; ++i)
    if (locator.locate(from_m + (i + 0.5) / kSamples * (to_m - from_m)).distance_m > 1e-9) return false;
  return true;
}

SolveWarning straight_span(const std::string& cable, std::size_t point, double length_m) {
  std::ostringstream text;
  text << "cable " << cable << " is straight for " << 1e3 * length_m << " mm of silicone after its point " << point
       << ", however the body bends there: set `via_points: per_element`, or give `path_m` in place of points_m";
  SolveWarning warning;
  warning.kind = "straight_in_silicone";
  warning.size = length_m;
  warning.unit = "m";
  warning.text = text.str();
  return warning;
}

}  // namespace

std::vector<SolveWarning> straight_cables(const YamlNode& scene, const Body& body, const MeshLocator& locator) {
  std::vector<SolveWarning> warnings;
  const double longest_m = kLongestSpan * mean_edge_m(body.mesh());
  for (const YamlNode& cable : scene.optional_sequence("cables")) {
    if (!cable.has("points_m") || cable.text_or("via_points", "given") != "given") continue;
    const std::vector<Eigen::Vector3d> path_m = read_cable_path(cable).points_m;
    std::size_t worst = 0;
    double worst_m = longest_m;
    for (std::size_t i = 0; i + 1 < path_m.size(); ++i) {
      const double length_m = (path_m[i + 1] - path_m[i]).norm();
      if (length_m <= worst_m || !in_silicone(path_m[i], path_m[i + 1], locator)) continue;
      worst = i;
      worst_m = length_m;
    }
    if (worst_m > longest_m) warnings.push_back(straight_span(read_name(cable), worst, worst_m));
  }
  return warnings;
}

}  // namespace soft_robot_lab
