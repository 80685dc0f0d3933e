// SPDX-License-Identifier: BSD-3-Clause
#include "mechanics/mesh/cable_path.h"

#include <algorithm>
#include <cmath>

#include <unsupported/Eigen/Splines>

#include "settings/read_points.h"

namespace soft_robot_lab {
namespace {

constexpr double kSagitta_m = 5e-5;  // a twentieth of a straw's radius
constexpr int kMostPieces = 64;      // of a span between two knots

using Curve = Eigen::Spline<double, 3>;

Curve spline_of(const std::vector<Eigen::Vector3d>& control_m) {
  const int count = static_cast<int>(control_m.size()), degree = std::min(3, count - 1), spans = count - degree;
  Curve::ControlPointVectorType control(3, count);
  for (int i = 0; i < count; ++i) control.col(i) = control_m[static_cast<std::size_t>(i)];
  Curve::KnotVectorType knots(count + degree + 1);
  for (int i = 0; i < knots.size(); ++i) knots[i] = std::clamp(i - degree, 0, spans) / static_cast<double>(spans);
  return {knots, control};
}

// How far the curve bulges from its chords, where each span between knots has so many pieces.
double bulge_m(const Curve& curve, int pieces) {
  double most = 0.0;
  for (int i = 0; i < pieces; ++i) {
    const Eigen::Vector3d from = curve(static_cast<double>(i) / pieces), to = curve((i + 1.0) / pieces);
    for (const double share : {0.25, 0.5, 0.75})  // an S has its middle on the chord
      most = std::max(most, (curve((i + share) / pieces).matrix() - from - share * (to - from)).norm());
  }
  return most;
}

}  // namespace

std::vector<Eigen::Vector3d> points_on_spline(const std::vector<Eigen::Vector3d>& control_m, double sagitta_m) {
  const Curve curve = spline_of(control_m);
  const int spans = static_cast<int>(control_m.size()) - static_cast<int>(curve.degree());
  int pieces = spans;
  while (pieces < kMostPieces * spans && bulge_m(curve, pieces) > sagitta_m) pieces *= 2;
  std::vector<Eigen::Vector3d> points_m;
  for (int i = 0; i <= pieces; ++i) points_m.emplace_back(curve(static_cast<double>(i) / pieces));
  return points_m;
}

CablePath read_cable_path(const YamlNode& cable) {
  CablePath path;
  int keys = 0;
  for (const char* key : {"points_m", "path_m", "spline_m"}) {
    if (!cable.has(key)) continue;
    path.key = key;
    ++keys;
  }
  if (keys != 1) cable.fail("must have one of points_m, path_m, spline_m");
  path.points_m = read_points(cable, path.key);
  const bool has_drive = path.key == "points_m" && cable.has("drive_points_m");
  if (path.points_m.size() < 2 && !has_drive)
    cable.fail(path.key + ": a cable needs at least two points, this one has " + std::to_string(path.points_m.size()));
  if (path.key == "spline_m") path.points_m = points_on_spline(path.points_m, kSagitta_m);
  return path;
}

YamlNode place_of(std::size_t i, const CablePath& path, const YamlNode& cable) {
  return path.key == "spline_m" ? cable.child(path.key) : cable.sequence(path.key)[i];
}

}  // namespace soft_robot_lab
