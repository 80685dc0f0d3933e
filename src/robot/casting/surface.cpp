// SPDX-License-Identifier: BSD-3-Clause
#include "surface.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <unordered_map>
#include <utility>

#include <Eigen/Geometry>

#include "robot/design/off_file.h"
#include "robot/design/orient.h"

namespace soft_robot_lab {
namespace {

// Each vertex's first twin: those at exactly the same place are one.
Eigen::Matrix3Xi joined(const Eigen::Matrix3Xd& vertices_m, const Eigen::Matrix3Xi& triangles) {
  std::map<std::array<double, 3>, int> first;
  Eigen::Matrix3Xi result = triangles;
  for (Eigen::Index i = 0; i < triangles.size(); ++i) {
    const int vertex = triangles(i);
    if (vertex < 0 || vertex >= vertices_m.cols())
      throw std::invalid_argument("a triangle names a vertex beyond the last");
    const Eigen::Vector3d at = vertices_m.col(vertex);
    if (!at.allFinite()) throw std::invalid_argument("a vertex is not finite");
    result(i) = first.emplace(std::array<double, 3>{at.x(), at.y(), at.z()}, vertex).first->second;
  }
  return result;
}

void measure(Surface& surface) {
  const Eigen::Index count = surface.triangles.cols();
  surface.normals.setZero(3, count);
  surface.areas_m2.setZero(count);
  for (int t = 0; t < count; ++t) {
    const Eigen::Vector3d a = surface.corner(t, 0);
    const Eigen::Vector3d twice = (surface.corner(t, 1) - a).cross(surface.corner(t, 2) - a);
    surface.areas_m2[t] = twice.norm() / 2;
    if (surface.areas_m2[t] > 0) surface.normals.col(t) = twice.normalized();
  }
}

[[noreturn]] void fail_open(const Surface& surface, int triangle, int edge) {
  const Eigen::Vector3d middle = (surface.corner(triangle, edge) + surface.corner(triangle, (edge + 1) % 3)) / 2;
  throw std::invalid_argument("the surface is not closed: an edge at " + place_text(middle) +
                              " is not shared by two triangles of one orientation");
}

void join_neighbours(Surface& surface) {
  const auto count = static_cast<std::uint64_t>(surface.vertices_m.cols());
  std::unordered_map<std::uint64_t, int> edges;  // from, to -> 3 * triangle + edge
  const auto key = [&](int t, int from, int to) {
    return static_cast<std::uint64_t>(surface.triangles(from, t)) * count +
           static_cast<std::uint64_t>(surface.triangles(to, t));
  };
  edges.reserve(static_cast<size_t>(surface.triangles.size()));
  for (int t = 0; t < surface.triangle_count(); ++t)
    for (int e = 0; e < 3; ++e)
      if (!edges.emplace(key(t, e, (e + 1) % 3), 3 * t + e).second) fail_open(surface, t, e);
  surface.neighbours.resize(3, surface.triangle_count());
  for (int t = 0; t < surface.triangle_count(); ++t) {
    for (int e = 0; e < 3; ++e) {
      const auto twin = edges.find(key(t, (e + 1) % 3, e));
      if (twin == edges.end()) fail_open(surface, t, e);
      surface.neighbours(e, t) = twin->second / 3;
    }
  }
}

double signed_volume_m3(const Surface& surface, int t) {
  return surface.corner(t, 0).dot(surface.corner(t, 1).cross(surface.corner(t, 2))) / 6;
}

void part_into_shells(Surface& surface) {
  surface.shell.assign(static_cast<size_t>(surface.triangle_count()), -1);
  std::vector<int> open;
  for (int seed = 0; seed < surface.triangle_count(); ++seed) {
    if (surface.shell[static_cast<size_t>(seed)] >= 0) continue;
    const int name = static_cast<int>(surface.shell_volumes_m3.size());
    surface.shell_volumes_m3.push_back(0);
    open.push_back(seed);
    surface.shell[static_cast<size_t>(seed)] = name;
    while (!open.empty()) {
      const int t = open.back();
      open.pop_back();
      surface.shell_volumes_m3.back() += signed_volume_m3(surface, t);
      for (const int next : surface.neighbours.col(t)) {
        if (surface.shell[static_cast<size_t>(next)] >= 0) continue;
        surface.shell[static_cast<size_t>(next)] = name;
        open.push_back(next);
      }
    }
  }
}

// Triangles without two different corners close no edge.
Eigen::Matrix3Xi without_slits(const Eigen::Matrix3Xi& triangles) {
  Eigen::Matrix3Xi kept(3, triangles.cols());
  Eigen::Index count = 0;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Eigen::Vector3i c = triangles.col(t);
    if (c[0] != c[1] && c[1] != c[2] && c[2] != c[0]) kept.col(count++) = c;
  }
  return kept.leftCols(count);
}

// Either way round, none longer than 0 where the kernel has none, and never far off the triangle's own: a facet stands
// off by up to half the angle between neighbours.
void take_true_normals(const Eigen::Matrix3Xd& normals, Surface& surface) {
  constexpr double kNear = 0.87;  // cosine of 30 degrees
  for (int t = 0; t < surface.triangle_count(); ++t) {
    const double cosine = normals.col(t).dot(surface.normals.col(t));
    if (std::abs(cosine) > kNear) surface.true_normals.col(t) = (cosine > 0 ? 1 : -1) * normals.col(t).normalized();
  }
}

}  // namespace

bool Surface::is_curved(int triangle) const {
  constexpr double kSmooth = 0.99996, kEdge = 0.87;  // cosines of half a degree and of 30 degrees
  for (const int other : neighbours.col(triangle)) {
    const double cosine = normals.col(triangle).dot(normals.col(other));
    if (cosine < kSmooth && cosine > kEdge) return true;
  }
  return false;
}

// A chord over an arc: half of it times the tangent of a quarter of the arc's angle, which neighbours share at most
// twice.
void Surface::estimate_sags() {
  constexpr double kEdge = 0.77, kMost = 0.02;  // cosine of 40 degrees; of the size
  const double most_m = kMost * size_m();
  sags_m = Eigen::VectorXd::Zero(triangle_count());
  for (int t = 0; t < triangle_count(); ++t)
    for (int e = 0; e < 3; ++e) {
      const double cosine = normals.col(t).dot(normals.col(neighbours(e, t)));
      if (cosine < kEdge || cosine >= 1) continue;
      const double width_m = 2 * areas_m2[t] / (corner(t, (e + 1) % 3) - corner(t, e)).norm();
      sags_m[t] = std::max(sags_m[t], std::min(most_m, width_m / 2 * std::tan(std::acos(cosine) / 2)));
    }
}

double Surface::volume_m3() const { return std::accumulate(shell_volumes_m3.begin(), shell_volumes_m3.end(), 0.0); }

double Surface::size_m() const { return (vertices_m.rowwise().maxCoeff() - vertices_m.rowwise().minCoeff()).norm(); }

Surface make_surface(const Eigen::Matrix3Xd& vertices_m, const Eigen::Matrix3Xi& triangles) {
  Surface surface;
  surface.vertices_m = vertices_m;
  surface.triangles = without_slits(joined(vertices_m, triangles));
  if (surface.triangles.cols() == 0) throw std::invalid_argument("the surface has no triangle");
  measure(surface);
  surface.true_normals = surface.normals;
  join_neighbours(surface);
  part_into_shells(surface);
  if (!(surface.volume_m3() > 0))
    throw std::invalid_argument("the surface encloses no volume, or its normals point inward");
  return surface;
}

Surface read_off(const std::string& path) {
  OffFile off = read_off_file(path);
  orient(off.vertices_m, off.triangles);
  Surface surface = make_surface(off.vertices_m, off.triangles);
  if (surface.triangle_count() == off.triangles.cols()) take_true_normals(off.normals, surface);
  return surface;
}

Eigen::Matrix3d frame_along(const Eigen::Vector3d& axis) {
  Eigen::Matrix3d frame;
  frame.col(2) = axis;
  frame.col(0) = axis.unitOrthogonal();
  frame.col(1) = axis.cross(frame.col(0));
  return frame;
}

std::string place_text(const Eigen::Vector3d& at_m) {
  std::ostringstream text;
  text.precision(4);
  const auto mm = [](double value_m) { return std::abs(value_m) < 5e-8 ? 0.0 : 1000 * value_m; };
  text << "(" << mm(at_m.x()) << ", " << mm(at_m.y()) << ", " << mm(at_m.z()) << ") mm";
  return text.str();
}

}  // namespace soft_robot_lab
