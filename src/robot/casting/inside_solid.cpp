// SPDX-License-Identifier: BSD-3-Clause
#include "inside_solid.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/Geometry>

namespace soft_robot_lab {
namespace {

using Eigen::Vector3d;
using Kind = Solid::Kind;

bool in_cone(const Solid& solid, const Vector3d& p) {
  const Vector3d axis = solid.end_m - solid.start_m;
  const double share = (p - solid.start_m).dot(axis) / axis.squaredNorm();
  if (share < 0 || share > 1) return false;
  const double radius = solid.radius_m + share * (solid.end_radius_m - solid.radius_m);
  return (p - solid.start_m - share * axis).norm() <= radius;
}

// By the number of edges that a ray along x crosses.
bool in_polygon(const std::vector<Eigen::Vector2d>& corners, const Eigen::Vector2d& p) {
  bool inside = false;
  for (size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
    const Eigen::Vector2d &a = corners[i], &b = corners[j];
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < a.x() + (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()))
      inside = !inside;
  }
  return inside;
}

bool in_prism(const Solid& solid, const Vector3d& p) {
  return p.z() >= solid.z_m[0] && p.z() <= solid.z_m[1] && in_polygon(solid.polygon_m, p.head<2>());
}

Vector3d turned_back(const Solid& solid, const Vector3d& p, double angle_deg) {
  const Eigen::AngleAxisd back(-angle_deg * M_PI / 180, solid.axis.normalized());
  return solid.center_m + back * (p - solid.center_m);
}

bool in_array(const Solid& solid, const Vector3d& p) {
  for (int i = 0; i < solid.count; ++i)
    if (contains(solid.parts[0], turned_back(solid, p - i * solid.by_m, i * solid.angle_deg))) return true;
  return false;
}

bool in_moved(const Solid& solid, const Vector3d& p) {
  const Solid& inner = solid.parts[0];
  const Vector3d normal = solid.axis.normalized();
  if (solid.kind == Kind::rotate) return contains(inner, turned_back(solid, p, solid.angle_deg));
  if (solid.kind == Kind::translate) return contains(inner, p - solid.by_m);
  if (solid.kind == Kind::scale) return contains(inner, solid.center_m + (p - solid.center_m) / solid.factor);
  if (solid.kind == Kind::mirror) return contains(inner, p - 2 * normal.dot(p - solid.center_m) * normal);
  return in_array(solid, p);
}

bool in_combination(const Solid& solid, const Vector3d& p) {
  const auto holds = [&](const Solid& part) { return contains(part, p); };
  const auto begin = solid.parts.begin(), end = solid.parts.end();
  if (solid.kind == Kind::union_of) return std::any_of(begin, end, holds);
  if (solid.kind == Kind::intersection) return std::all_of(begin, end, holds);
  return holds(*begin) && std::none_of(begin + 1, end, holds);
}

}  // namespace

bool has_equations(const Solid& solid) {
  const bool curved = solid.kind == Kind::sweep || solid.kind == Kind::fillet;
  return !curved && solid.file.empty() && std::all_of(solid.parts.begin(), solid.parts.end(), has_equations);
}

bool contains(const Solid& solid, const Vector3d& point_m) {
  if (!has_equations(solid)) throw std::invalid_argument("files, sweeps and fillets have no equations");
  if (solid.moves()) return in_moved(solid, point_m);
  if (!solid.parts.empty()) return in_combination(solid, point_m);
  switch (solid.kind) {
    case Kind::box:
      return ((point_m - solid.center_m).cwiseAbs().array() <= solid.size_m.array() / 2).all();
    case Kind::sphere:
      return (point_m - solid.center_m).norm() <= solid.radius_m;
    case Kind::extrude:
      return in_prism(solid, point_m);
    default:
      return in_cone(solid, point_m);
  }
}

}  // namespace soft_robot_lab
