// SPDX-License-Identifier: BSD-3-Clause
#include "angles.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

namespace soft_robot_lab {
namespace {

constexpr size_t kMostTriangles = 200;  // around one edge
constexpr double kFlat = 1.0 * M_PI / 180;
constexpr double kWorthwhile = 45 * M_PI / 180;  // of turning that the radius can hold, by the edge's own curvature

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return 2 * std::atan2((a - b).norm(), (a + b).norm());
}

double height_m(const Surface& surface, int triangle, double edge_m) { return 2 * surface.areas_m2[triangle] / edge_m; }

// What lies around an edge: triangles, and a point of each near the edge but inside it.
struct Around {
  std::vector<int> triangles;
  std::vector<Eigen::Vector3d> points_m;
};

Around gather(const Surface& surface, int triangle, const Eigen::Vector3d& middle, double radius_m) {
  Around around;
  around.triangles.push_back(triangle);
  for (size_t next = 0; next < around.triangles.size() && around.triangles.size() < kMostTriangles; ++next) {
    for (const int other : surface.neighbours.col(around.triangles[next])) {
      const auto& all = around.triangles;
      if (std::find(all.begin(), all.end(), other) != all.end()) continue;
      if ((nearest_point(surface, other, middle) - middle).norm() <= radius_m) around.triangles.push_back(other);
    }
  }
  for (const int t : around.triangles) {
    const Eigen::Vector3d q = nearest_point(surface, t, middle), inward = surface.centre(t) - q;
    around.points_m.push_back(q + std::min(1.0, radius_m / std::max(inward.norm(), 1e-12)) * inward);
  }
  return around;
}

// Largest angle between the normals of two of them that face each other (+1) or turn away from each other (-1).
double largest_turn(const Surface& surface, const Around& around, int sign) {
  double longest = 0;  // squared chord between both normals, which grows with their angle
  Eigen::Vector3d a = Eigen::Vector3d::UnitZ(), b = a;
  for (size_t i = 0; i < around.triangles.size(); ++i) {
    const Eigen::Vector3d n = surface.normals.col(around.triangles[i]);
    for (size_t j = 0; j < i; ++j) {
      const Eigen::Vector3d other = surface.normals.col(around.triangles[j]),
                            way = around.points_m[j] - around.points_m[i];
      const double chord = (n - other).squaredNorm();
      if (chord <= longest || sign * way.dot(n) <= 0 || sign * way.dot(other) >= 0) continue;
      longest = chord, a = n, b = other;
    }
  }
  return angle_between(a, b);
}

void keep(SharpEdge& worst, double turn, const Eigen::Vector3d& at, double length_m, double limit_deg) {
  const double opening = 180 - turn * 180 / M_PI;
  if (opening < limit_deg) worst.length_m += length_m;
  if (opening >= worst.opening_deg) return;
  worst.opening_deg = opening;
  worst.at_m = at;
}

void measure_edge(const Surface& surface, int t, int e, double radius_m, double limit_deg, EdgeAngles& result) {
  const int other = surface.neighbours(e, t);
  if (other < t || surface.areas_m2[t] <= 0 || surface.areas_m2[other] <= 0) return;
  const Eigen::Vector3d a = surface.corner(t, e), b = surface.corner(t, (e + 1) % 3), n = surface.normals.col(t);
  const double length = (b - a).norm(), turn = angle_between(n, surface.normals.col(other));
  const double width = (height_m(surface, t, length) + height_m(surface, other, length)) / 2;
  if (turn < kFlat || turn * std::max(1.0, 2 * radius_m / width) < kWorthwhile) return;
  const Around around = gather(surface, t, (a + b) / 2, radius_m);
  const bool concave = (surface.centre(other) - a).dot(n) > 0;
  const double most = std::max(turn, largest_turn(surface, around, concave ? 1 : -1));
  keep(concave ? result.notch : result.wedge, most, (a + b) / 2, length, limit_deg);
}

}  // namespace

EdgeAngles measure_angles(const Surface& surface, double radius_m, double limit_deg) {
  EdgeAngles result;
  for (int t = 0; t < surface.triangle_count(); ++t)
    for (int e = 0; e < 3; ++e) measure_edge(surface, t, e, radius_m, limit_deg, result);
  return result;
}

}  // namespace soft_robot_lab
