// SPDX-License-Identifier: BSD-3-Clause
// Closed surfaces of triangles for tests of obstacles from meshes.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace soft_robot_lab {

struct Triangles {
  Eigen::Matrix3Xd vertices_m;
  Eigen::Matrix3Xi triangles;
};

// Corners counter-clockwise from outside, four each.
inline Triangles of_quads(const std::vector<Eigen::Vector3d>& corners, const std::vector<std::array<int, 4>>& quads) {
  Triangles all{Eigen::Matrix3Xd(3, static_cast<Eigen::Index>(corners.size())),
                Eigen::Matrix3Xi(3, 2 * static_cast<Eigen::Index>(quads.size()))};
  for (std::size_t i = 0; i < corners.size(); ++i) all.vertices_m.col(static_cast<Eigen::Index>(i)) = corners[i];
  Eigen::Index column = 0;
  for (const auto& q : quads) {
    all.triangles.col(column++) = Eigen::Vector3i(q[0], q[1], q[2]);
    all.triangles.col(column++) = Eigen::Vector3i(q[0], q[2], q[3]);
  }
  return all;
}

// An outline in x and y, counter-clockwise, from z = 0 to `height_m`; `ends`: quads of its corners that fill it.
inline Triangles prism(const std::vector<Eigen::Vector2d>& outline, double height_m,
                       const std::vector<std::array<int, 4>>& ends) {
  const int count = static_cast<int>(outline.size());
  std::vector<Eigen::Vector3d> corners;
  for (const double z : {0.0, height_m})
    for (const Eigen::Vector2d& at : outline) corners.emplace_back(at.x(), at.y(), z);
  std::vector<std::array<int, 4>> quads;
  for (int i = 0; i < count; ++i) {
    const int next = (i + 1) % count;
    quads.push_back({i, next, next + count, i + count});
  }
  for (const auto& q : ends) {
    quads.push_back({q[3], q[2], q[1], q[0]});
    quads.push_back({q[0] + count, q[1] + count, q[2] + count, q[3] + count});
  }
  return of_quads(corners, quads);
}

inline Triangles box_triangles(const Eigen::Vector3d& center_m, const Eigen::Vector3d& size_m) {
  const Eigen::Vector3d h = 0.5 * size_m;
  Triangles box =
      prism({{-h.x(), -h.y()}, {h.x(), -h.y()}, {h.x(), h.y()}, {-h.x(), h.y()}}, size_m.z(), {{0, 1, 2, 3}});
  box.vertices_m.colwise() += center_m - Eigen::Vector3d(0, 0, h.z());
  return box;
}

// An L in x and y: both arms `arm_m` wide, `long_m` long.
inline Triangles l_triangles(double long_m, double arm_m, double height_m) {
  return prism({{0, 0}, {long_m, 0}, {long_m, arm_m}, {arm_m, arm_m}, {arm_m, long_m}, {0, long_m}}, height_m,
               {{0, 1, 2, 3}, {0, 3, 4, 5}});
}

// An outline of radii and heights that begins and ends on the y axis, turned about it: counter-clockwise with the
// radius to the right and y up.
inline Triangles turned(const std::vector<Eigen::Vector2d>& outline, int segments) {
  const int inner = static_cast<int>(outline.size()) - 2;
  Triangles all{Eigen::Matrix3Xd(3, inner * segments + 2), Eigen::Matrix3Xi(3, 2 * inner * segments)};
  const auto vertex = [&](int ring, int i) { return 1 + ring * segments + i % segments; };
  all.vertices_m.col(0) << 0.0, outline.front().y(), 0.0;
  all.vertices_m.rightCols<1>() << 0.0, outline.back().y(), 0.0;
  Eigen::Index column = 0;
  for (int i = 0; i < segments; ++i) {
    const double angle_rad = 2.0 * M_PI * i / segments;
    for (int ring = 0; ring < inner; ++ring) {
      const Eigen::Vector2d& at = outline[static_cast<std::size_t>(ring + 1)];
      all.vertices_m.col(vertex(ring, i)) << at.x() * std::cos(angle_rad), at.y(), at.x() * std::sin(angle_rad);
    }
    all.triangles.col(column++) << 0, vertex(0, i), vertex(0, i + 1);
    for (int ring = 0; ring + 1 < inner; ++ring) {
      all.triangles.col(column++) << vertex(ring, i), vertex(ring + 1, i), vertex(ring + 1, i + 1);
      all.triangles.col(column++) << vertex(ring, i), vertex(ring + 1, i + 1), vertex(ring, i + 1);
    }
    all.triangles.col(column++) << vertex(inner - 1, i), static_cast<int>(all.vertices_m.cols()) - 1,
        vertex(inner - 1, i + 1);
  }
  return all;
}

// An octahedron whose triangles are quartered `rounds` times.
inline Triangles sphere_triangles(const Eigen::Vector3d& center_m, double radius_m, int rounds) {
  std::vector<Eigen::Vector3d> at{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<Eigen::Vector3i> of{{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                  {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int round = 0; round < rounds; ++round) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [found, fresh] = middles.emplace(std::minmax(a, b), static_cast<int>(at.size()));
      if (fresh) at.push_back((at[static_cast<std::size_t>(a)] + at[static_cast<std::size_t>(b)]).normalized());
      return found->second;
    };
    std::vector<Eigen::Vector3i> finer;
    for (const Eigen::Vector3i& t : of) {
      const int ab = middle(t[0], t[1]), bc = middle(t[1], t[2]), ca = middle(t[2], t[0]);
      for (const Eigen::Vector3i& one : {Eigen::Vector3i(t[0], ab, ca), {ab, t[1], bc}, {ca, bc, t[2]}, {ab, bc, ca}})
        finer.push_back(one);
    }
    of = finer;
  }
  Triangles all{Eigen::Matrix3Xd(3, static_cast<Eigen::Index>(at.size())),
                Eigen::Matrix3Xi(3, static_cast<Eigen::Index>(of.size()))};
  for (std::size_t i = 0; i < at.size(); ++i)
    all.vertices_m.col(static_cast<Eigen::Index>(i)) = center_m + radius_m * at[i];
  for (std::size_t i = 0; i < of.size(); ++i) all.triangles.col(static_cast<Eigen::Index>(i)) = of[i];
  return all;
}

// The same surface in another order.
inline Triangles shuffled(const Triangles& from, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<int> vertices(static_cast<std::size_t>(from.vertices_m.cols())),
      triangles(static_cast<std::size_t>(from.triangles.cols()));
  for (std::size_t i = 0; i < vertices.size(); ++i) vertices[i] = static_cast<int>(i);
  for (std::size_t i = 0; i < triangles.size(); ++i) triangles[i] = static_cast<int>(i);
  std::shuffle(vertices.begin(), vertices.end(), random);
  std::shuffle(triangles.begin(), triangles.end(), random);
  Triangles to{from.vertices_m(Eigen::all, vertices), from.triangles(Eigen::all, triangles)};
  std::vector<int> now(vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) now[static_cast<std::size_t>(vertices[i])] = static_cast<int>(i);
  for (auto t : to.triangles.colwise()) {
    const Eigen::Vector3i named = t.unaryExpr([&](int vertex) { return now[static_cast<std::size_t>(vertex)]; });
    const int first = static_cast<int>(random() % 3);
    t = Eigen::Vector3i(named[first], named[(first + 1) % 3], named[(first + 2) % 3]);
  }
  return to;
}

}  // namespace soft_robot_lab
