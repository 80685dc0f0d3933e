// SPDX-License-Identifier: BSD-3-Clause
// Closed surfaces with known answers.
#pragma once

#include <cmath>
#include <vector>

#include <Eigen/Core>

#include "robot/casting/surface.h"

namespace soft_robot_lab {

constexpr double kPi = 3.14159265358979323846;

struct Shape {
  std::vector<Eigen::Vector3d> vertices_m;
  std::vector<Eigen::Vector3i> triangles;

  int vertex(const Eigen::Vector3d& at_m) {
    vertices_m.push_back(at_m);
    return static_cast<int>(vertices_m.size()) - 1;
  }
  void triangle(int a, int b, int c) { triangles.emplace_back(a, b, c); }
  void quad(int a, int b, int c, int d) { triangle(a, b, c), triangle(a, c, d); }
  void turn_inside_out() {
    for (auto& t : triangles) std::swap(t[1], t[2]);
  }
  void add(const Shape& other) {
    const int first = static_cast<int>(vertices_m.size());
    for (const auto& v : other.vertices_m) vertices_m.push_back(v);
    for (const auto& t : other.triangles) triangles.emplace_back(t.array() + first);
  }
  Surface surface() const {
    Eigen::Matrix3Xd positions(3, static_cast<Eigen::Index>(vertices_m.size()));
    Eigen::Matrix3Xi corners(3, static_cast<Eigen::Index>(triangles.size()));
    for (size_t i = 0; i < vertices_m.size(); ++i) positions.col(static_cast<Eigen::Index>(i)) = vertices_m[i];
    for (size_t i = 0; i < triangles.size(); ++i) corners.col(static_cast<Eigen::Index>(i)) = triangles[i];
    return make_surface(positions, corners);
  }
};

// A frustum along z: a rectangle of half sizes below, another above, moved sideways.
inline Shape frustum(const Eigen::Vector2d& below, const Eigen::Vector2d& above, double height,
                     const Eigen::Vector2d& moved = Eigen::Vector2d::Zero(), double z = 0) {
  Shape s;
  for (int level = 0; level < 2; ++level) {
    const Eigen::Vector2d half = level == 0 ? below : above, by = level == 0 ? Eigen::Vector2d(0, 0) : moved;
    for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
      s.vertex({by.x() + x * half.x(), by.y() + y * half.y(), z + level * height});
  }
  s.quad(3, 2, 1, 0), s.quad(4, 5, 6, 7);
  for (int i = 0; i < 4; ++i) s.quad(i, (i + 1) % 4, 4 + (i + 1) % 4, 4 + i);
  return s;
}

inline Shape box(const Eigen::Vector3d& size, double z = 0) {
  const Eigen::Vector2d half = size.head<2>() / 2;
  return frustum(half, half, size.z(), {0, 0}, z);
}

// A prism along y of a polygon in x, z that goes round counter-clockwise seen from -y. It must be a star around
// `heart`.
inline Shape prism(const std::vector<Eigen::Vector2d>& corners, double length, const Eigen::Vector2d& heart) {
  Shape s;
  const int n = static_cast<int>(corners.size());
  for (const double y : {0.0, length})
    for (const auto& c : corners) s.vertex({c.x(), y, c.y()});
  const int front = s.vertex({heart.x(), 0, heart.y()}), back = s.vertex({heart.x(), length, heart.y()});
  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n;
    s.triangle(front, i, j), s.triangle(back, n + j, n + i);
    s.quad(i, n + i, n + j, j);
  }
  return s;
}

// A body of revolution around z of a closed outline in r > 0 and z, counter-clockwise with r to the right.
inline Shape revolved(const std::vector<Eigen::Vector2d>& outline, int around) {
  Shape s;
  const int n = static_cast<int>(outline.size());
  for (int k = 0; k < around; ++k)
    for (const auto& c : outline) {
      const double turn = 2 * kPi * k / around;
      s.vertex({c.x() * std::cos(turn), c.x() * std::sin(turn), c.y()});
    }
  for (int k = 0; k < around; ++k)
    for (int i = 0; i < n; ++i)
      s.quad(k * n + i, (k + 1) % around * n + i, (k + 1) % around * n + (i + 1) % n, k * n + (i + 1) % n);
  return s;
}

// A pipe around z.
inline Shape pipe(double outer, double inner, double height, int around) {
  return revolved({{inner, 0}, {outer, 0}, {outer, height}, {inner, height}}, around);
}

// A full cylinder around z.
inline Shape rod(double radius, double height, int around) {
  Shape s;
  const int low = s.vertex({0, 0, 0}), high = s.vertex({0, 0, height});
  for (int k = 0; k < around; ++k) {
    const double turn = 2 * kPi * k / around;
    for (const double z : {0.0, height}) s.vertex({radius * std::cos(turn), radius * std::sin(turn), z});
  }
  for (int k = 0; k < around; ++k) {
    const int a = 2 + 2 * k, b = 2 + 2 * ((k + 1) % around);
    s.triangle(low, b, a), s.triangle(high, a + 1, b + 1), s.quad(a, b, b + 1, a + 1);
  }
  return s;
}

// An upright cylinder with a blind bore from below: the roof is as thick as `roof`.
inline Shape cup(double outer, double inner, double height, double roof, int around) {
  Shape s;
  const auto ring = [&](double radius, double z) {
    const int first = static_cast<int>(s.vertices_m.size());
    for (int k = 0; k < around; ++k)
      s.vertex({radius * std::cos(2 * kPi * k / around), radius * std::sin(2 * kPi * k / around), z});
    return first;
  };
  const auto band = [&](int low, int high) {
    for (int k = 0; k < around; ++k) s.quad(low + k, low + (k + 1) % around, high + (k + 1) % around, high + k);
  };
  const int top = ring(outer, height), foot = ring(outer, 0), mouth = ring(inner, 0), end = ring(inner, height - roof);
  const int crown = s.vertex({0, 0, height}), ceiling = s.vertex({0, 0, height - roof});
  band(foot, top), band(end, mouth), band(mouth, foot);
  for (int k = 0; k < around; ++k) {
    s.triangle(crown, top + k, top + (k + 1) % around);
    s.triangle(ceiling, end + (k + 1) % around, end + k);
  }
  return s;
}

}  // namespace soft_robot_lab
