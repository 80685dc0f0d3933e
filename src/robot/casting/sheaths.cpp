// SPDX-License-Identifier: BSD-3-Clause
#include "sheaths.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace soft_robot_lab {
namespace {

constexpr int kAround = 24;  // rays across a sheath

struct Station {
  Eigen::Vector3d at_m, along;
};

// Points along a path, half a radius apart.
std::vector<Station> stations(const SheathPath& path) {
  std::vector<Station> all;
  for (size_t i = 0; i + 1 < path.points_m.size(); ++i) {
    const Eigen::Vector3d from = path.points_m[i], way = path.points_m[i + 1] - from;
    if (way.norm() == 0) continue;
    const int count = std::clamp(static_cast<int>(std::ceil(2 * way.norm() / path.radius_m)), 1, 2000);
    for (int k = 0; k < count; ++k) all.push_back({from + (k + 0.5) / count * way, way.normalized()});
  }
  return all;
}

double room_along_m(const RayTree& tree, const Station& station, double sign) {
  const auto hit = tree.first_hit(station.at_m, sign * station.along, 0);
  return hit ? hit->distance_m : 0;
}

// Inside the solid, and not where the cable comes out.
bool is_embedded(const RayTree& tree, const Station& station, double radius_m) {
  if (!is_inside(tree, station.at_m)) return false;
  return std::min(room_along_m(tree, station, 1), room_along_m(tree, station, -1)) > 2 * radius_m;
}

double room_across_m(const RayTree& tree, const Station& station) {
  const Eigen::Vector3d u = station.along.unitOrthogonal(), v = station.along.cross(u);
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kAround; ++i) {
    const double turn = 2 * M_PI * i / kAround;
    const auto hit = tree.first_hit(station.at_m, std::cos(turn) * u + std::sin(turn) * v, 0);
    if (hit) least = std::min(least, hit->distance_m);
  }
  return least;
}

void keep(WorstAlong& worst, double value_m, const Eigen::Vector3d& at, const std::string& cable,
          const std::string& other = "") {
  if (value_m < worst.worst_m) worst = {value_m, at, cable, other};
}

}  // namespace

bool is_inside(const RayTree& tree, const Eigen::Vector3d& point_m) {
  int inside = 0;
  for (const Eigen::Vector3d& direction :
       {Eigen::Vector3d(0.5321, 0.2713, 0.8021), Eigen::Vector3d(-0.3171, 0.9011, 0.2957),
        Eigen::Vector3d(0.1339, -0.7411, 0.6579)}) {
    const Eigen::Vector3d way = direction.normalized();
    const auto hit = tree.first_hit(point_m, way, 0);
    if (hit && tree.surface().normals.col(hit->triangle).dot(way) > 0) ++inside;
  }
  return inside >= 2;
}

Eigen::Vector3d point_along(const std::vector<Eigen::Vector3d>& points_m, double length_m) {
  for (size_t i = 0; i + 1 < points_m.size(); ++i) {
    const double segment = (points_m[i + 1] - points_m[i]).norm();
    if (length_m <= segment || i + 2 == points_m.size())
      return points_m[i] + std::min(1.0, length_m / segment) * (points_m[i + 1] - points_m[i]);
    length_m -= segment;
  }
  return points_m.front();
}

WorstAlong tightest_bend(const std::vector<SheathPath>& paths) {
  WorstAlong worst;
  for (const SheathPath& path : paths) {
    for (size_t i = 1; i + 1 < path.points_m.size(); ++i) {
      const Eigen::Vector3d in = path.points_m[i] - path.points_m[i - 1], out = path.points_m[i + 1] - path.points_m[i];
      if (in.norm() == 0 || out.norm() == 0) continue;
      const double turn = std::atan2(in.cross(out).norm(), in.dot(out));
      if (turn < 1e-6) continue;
      const double radius = std::min(in.norm(), out.norm()) / 2 / std::tan(std::min(turn, 0.9999 * M_PI) / 2);
      keep(worst, radius, path.points_m[i], path.name);
    }
  }
  return worst;
}

WorstAlong thinnest_cover(const RayTree& tree, const std::vector<SheathPath>& paths) {
  WorstAlong worst;
  for (const SheathPath& path : paths)
    for (const Station& station : stations(path))
      if (is_embedded(tree, station, path.radius_m))
        keep(worst, room_across_m(tree, station) - path.radius_m, station.at_m, path.name);
  return worst;
}

WorstAlong nearest_sheaths(const RayTree& tree, const std::vector<SheathPath>& paths) {
  WorstAlong worst;
  for (size_t i = 0; i < paths.size(); ++i) {
    for (const Station& a : stations(paths[i])) {
      if (paths.size() < 2 || !is_inside(tree, a.at_m)) continue;
      for (size_t j = 0; j < i; ++j)
        for (const Station& b : stations(paths[j]))
          keep(worst, (a.at_m - b.at_m).norm() - paths[i].radius_m - paths[j].radius_m, a.at_m, paths[i].name,
               paths[j].name);
    }
  }
  return worst;
}

}  // namespace soft_robot_lab
