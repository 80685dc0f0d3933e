// SPDX-License-Identifier: BSD-3-Clause
#include "closed_surface.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "settings/point_text.h"

namespace soft_robot_lab {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kAsLarge = 1e-6;         // of a face
constexpr double kStandsOut = 1e-3;       // sine of an angle between two triangles
constexpr double kOnePlane = 1.0 - 1e-6;  // cosine of 0.08 degrees between triangles of one face

}  // namespace

ClosedSurface::ClosedSurface(const Eigen::Matrix3Xd& vertices_m, const Eigen::Matrix3Xi& triangles)
    : vertices_m_(vertices_m), triangles_(triangles) {
  if (triangles.cols() == 0) throw std::invalid_argument("holds no triangles");
  if (!vertices_m.allFinite()) throw std::invalid_argument("a vertex is not finite");
  if (triangles.minCoeff() < 0 || triangles.maxCoeff() >= vertices_m.cols())
    throw std::invalid_argument("a triangle names a vertex beyond the last");
  join_neighbours();
  measure();
}

void ClosedSurface::join_neighbours() {
  struct Side {
    int from, to, at;  // the latter: 3 times the triangle, plus the side
  };
  std::vector<Side> sides;
  for (int t = 0; t < count(); ++t)
    for (int side = 0; side < 3; ++side)
      sides.push_back({triangles_(side, t), triangles_((side + 1) % 3, t), 3 * t + side});
  const auto along = [](const Side& side) { return std::pair(side.from, side.to); };
  std::sort(sides.begin(), sides.end(), [&](const Side& a, const Side& b) { return along(a) < along(b); });
  const auto refuse = [&](const Side& side) {
    throw std::invalid_argument("its surface is not closed: the edge at " +
                                point_text(0.5 * (vertices_m_.col(side.from) + vertices_m_.col(side.to))) +
                                " has not one triangle on either side");
  };
  neighbours_.resize(3, count());
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (i > 0 && along(sides[i]) == along(sides[i - 1])) refuse(sides[i]);
    const std::pair wanted(sides[i].to, sides[i].from);
    const auto back = std::lower_bound(sides.begin(), sides.end(), wanted,
                                       [&](const Side& side, const auto& way) { return along(side) < way; });
    if (back == sides.end() || along(*back) != wanted) refuse(sides[i]);
    neighbours_(sides[i].at % 3, sides[i].at / 3) = back->at / 3;
  }
}

// Volume, centroid and inertia are sums over tetrahedra from the first vertex.
void ClosedSurface::measure() {
  normals_.setZero(3, count());
  of_corners_.setZero(3, vertices_m_.cols());
  areas_m2_.setZero(count());
  const Vector3d from_m = vertices_m_.col(0);
  Vector3d first_m4 = Vector3d::Zero();
  Matrix3d second_m5 = Matrix3d::Zero();
  for (Eigen::Index t = 0; t < count(); ++t) {
    const Matrix3d at_m = corners_m(t).colwise() - from_m;
    const Vector3d twice_m2 = (at_m.col(1) - at_m.col(0)).cross(at_m.col(2) - at_m.col(0));
    areas_m2_[t] = 0.5 * twice_m2.norm();
    if (areas_m2_[t] > 0.0) normals_.col(t) = twice_m2.normalized();
    for (int k = 0; k < 3; ++k) {
      const Vector3d one = at_m.col((k + 1) % 3) - at_m.col(k), other = at_m.col((k + 2) % 3) - at_m.col(k);
      of_corners_.col(triangles_(k, t)) += std::atan2(one.cross(other).norm(), one.dot(other)) * normals_.col(t);
    }
    const double volume_m3 = at_m.col(0).dot(twice_m2) / 6.0;
    const Vector3d sum_m = at_m.rowwise().sum();
    volume_m3_ += volume_m3;
    first_m4 += volume_m3 / 4.0 * sum_m;
    second_m5 += volume_m3 / 20.0 * (at_m * at_m.transpose() + sum_m * sum_m.transpose());
  }
  if (!(volume_m3_ > 0.0))
    throw std::invalid_argument("its triangles face inward, or enclose no volume; turn them to face outward");
  centroid_m_ = from_m + first_m4 / volume_m3_;
  second_m5 -= first_m4 * first_m4.transpose() / volume_m3_;
  inertia_m5_ = second_m5.trace() * Matrix3d::Identity() - second_m5;
}

Vector3d ClosedSurface::outward(Eigen::Index triangle, const NearestOnTriangle& place) const {
  if (place.corner >= 0) return of_corners_.col(triangles_(place.corner, triangle));
  if (place.side >= 0) return normals_.col(triangle) + normals_.col(neighbours_(place.side, triangle));
  return normals_.col(triangle);
}

std::vector<ClosedSurface::Edge> ClosedSurface::edges_standing_out() const {
  std::vector<Edge> edges;
  for (int t = 0; t < count(); ++t) {
    for (int side = 0; side < 3; ++side) {
      const int from = triangles_(side, t), to = triangles_((side + 1) % 3, t), beyond = neighbours_(side, t);
      for (const int corner : triangles_.col(beyond)) {
        const Vector3d way_m = vertices_m_.col(corner) - vertices_m_.col(from), one = normals_.col(t);
        if (corner == from || corner == to || one.dot(way_m) > -kStandsOut * way_m.norm()) continue;
        edges.push_back({std::min(from, to), std::max(from, to), {one, normals_.col(beyond)}});
      }
    }
  }
  // Both of its triangles see it.
  const auto ends = [](const Edge& edge) { return std::pair(edge.from, edge.to); };
  std::sort(edges.begin(), edges.end(), [&](const Edge& a, const Edge& b) { return ends(a) < ends(b); });
  edges.erase(std::unique(edges.begin(), edges.end(), [&](const Edge& a, const Edge& b) { return ends(a) == ends(b); }),
              edges.end());
  return edges;
}

std::vector<ClosedSurface::Edge> ClosedSurface::lines_standing_out() const {
  const std::vector<Edge> edges = edges_standing_out();
  std::multimap<int, std::size_t> at;
  for (std::size_t i = 0; i < edges.size(); ++i)
    for (const int end : {edges[i].from, edges[i].to}) at.emplace(end, i);
  const auto along = [&](int from, int to) -> Vector3d {
    return (vertices_m_.col(to) - vertices_m_.col(from)).normalized();
  };
  const auto same_faces = [](const Edge& a, const Edge& b) {
    const auto same = [&](std::size_t of_b) {
      return a.normals[0].dot(b.normals[of_b]) > kOnePlane && a.normals[1].dot(b.normals[1 - of_b]) > kOnePlane;
    };
    return same(0) || same(1);
  };
  std::vector<char> used(edges.size(), 0);
  // Goes on from the line's end `to`, until nothing does.
  const auto grow = [&](const Edge& first, int from, int to) {
    for (bool grows = true; grows;) {
      grows = false;
      const auto [begin, end] = at.equal_range(to);
      for (auto next = begin; next != end && !grows; ++next) {
        const Edge& edge = edges[next->second];
        const int beyond = edge.from == to ? edge.to : edge.from;
        if (used[next->second] != 0 || !same_faces(first, edge) || along(from, to).dot(along(to, beyond)) < kOnePlane)
          continue;
        used[next->second] = 1;
        to = beyond;
        grows = true;
      }
    }
    return to;
  };
  std::vector<Edge> lines;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (used[i] != 0) continue;
    used[i] = 1;
    const Edge& edge = edges[i];
    const int to = grow(edge, edge.from, edge.to);
    lines.push_back({grow(edge, edge.to, edge.from), to, edge.normals});
  }
  return lines;
}

double ClosedSurface::Edge::angle_rad() const {
  return std::atan2(normals[0].cross(normals[1]).norm(), normals[0].dot(normals[1]));
}

std::vector<int> ClosedSurface::standing_out() const {
  std::vector<char> stands(static_cast<std::size_t>(vertices_m_.cols()), 0);
  for (const Edge& edge : edges_standing_out())
    stands[static_cast<std::size_t>(edge.from)] = stands[static_cast<std::size_t>(edge.to)] = 1;
  std::vector<int> vertices;
  for (int vertex = 0; vertex < vertices_m_.cols(); ++vertex)
    if (stands[static_cast<std::size_t>(vertex)] != 0) vertices.push_back(vertex);
  return vertices;
}

std::vector<Vector3d> ClosedSurface::faces_m2() const {
  std::vector<Vector3d> faces;
  std::vector<char> seen(static_cast<std::size_t>(count()), 0);
  std::vector<Eigen::Index> open;
  for (Eigen::Index seed = 0; seed < count(); ++seed) {
    if (seen[static_cast<std::size_t>(seed)] != 0 || areas_m2_[seed] == 0.0) continue;
    Vector3d sum_m2 = Vector3d::Zero();
    open.assign(1, seed);
    seen[static_cast<std::size_t>(seed)] = 1;
    while (!open.empty()) {
      const Eigen::Index t = open.back();
      open.pop_back();
      sum_m2 += areas_m2_[t] * normals_.col(t);
      for (const int next : neighbours_.col(t)) {
        if (seen[static_cast<std::size_t>(next)] != 0 || normals_.col(next).dot(normals_.col(seed)) < kOnePlane)
          continue;
        seen[static_cast<std::size_t>(next)] = 1;
        open.push_back(next);
      }
    }
    faces.push_back(sum_m2);
  }
  return faces;
}

// Of faces that are as large as the largest, as those of a ball, the one that looks most along a way on which hardly
// two agree.
Matrix3d ClosedSurface::frame() const {
  const std::vector<Vector3d> faces = faces_m2();
  const Vector3d decides(1.0, std::sqrt(0.57), std::sqrt(0.33));
  const auto largest = [&](const Matrix3d& seen) -> Vector3d {
    double most_m2 = 0.0;
    for (const Vector3d& face_m2 : faces) most_m2 = std::max(most_m2, (seen * face_m2).norm());
    Vector3d best = Vector3d::Zero();
    for (const Vector3d& face_m2 : faces) {
      const Vector3d one = seen * face_m2;
      if (one.norm() < (1.0 - kAsLarge) * most_m2) continue;
      if (best.isZero(0.0) || decides.dot(one) > decides.dot(best)) best = one;
    }
    return best.normalized();
  };
  Matrix3d frame;
  frame.col(0) = largest(Matrix3d::Identity());
  frame.col(1) = largest(Matrix3d::Identity() - frame.col(0) * frame.col(0).transpose());
  frame.col(2) = frame.col(0).cross(frame.col(1));
  return frame;
}

}  // namespace soft_robot_lab
