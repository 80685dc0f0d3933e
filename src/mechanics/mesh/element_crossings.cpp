// SPDX-License-Identifier: BSD-3-Clause
#include "element_crossings.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace soft_robot_lab {
namespace {

constexpr double kOnFace = 1e-9;   // in barycentric coordinates
constexpr double kTouched = 0.01;  // of an element's longest edge: a shorter way only touches it
constexpr double kSameWay = 0.5;   // of the shorter of two ways: elements that share more lie side by side

bool boxes_meet(const TetCorners& corners, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Array3d least = corners.rowwise().minCoeff(), most = corners.rowwise().maxCoeff();
  const Eigen::Array3d margin = kOnFace * (most - least);
  return (a.cwiseMin(b).array() <= most + margin).all() && (a.cwiseMax(b).array() >= least - margin).all();
}

Eigen::Vector4d barycentric(const TetCorners& corners, const Eigen::Vector3d& point) {
  Eigen::Matrix3d edges;
  for (int i = 0; i < 3; ++i) edges.col(i) = corners.col(i + 1) - corners.col(0);
  const Eigen::Vector3d inner = edges.partialPivLu().solve(point - corners.col(0));
  return {1.0 - inner.sum(), inner.x(), inner.y(), inner.z()};
}

double longest_edge_m(const TetCorners& corners) {
  double longest = 0.0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < i; ++j) longest = std::max(longest, (corners.col(i) - corners.col(j)).norm());
  return longest;
}

// The part of [0, 1] in which all four coordinates are not negative; `to` < `from` where there is none.
ElementCrossing clip(int tet, const Eigen::Vector4d& at_start, const Eigen::Vector4d& at_end) {
  ElementCrossing crossing{tet, 0.0, 1.0};
  for (int i = 0; i < 4; ++i) {
    const double rate = at_end[i] - at_start[i];
    if (std::abs(rate) < kOnFace) {
      if (at_start[i] < -kOnFace) crossing.to = -1.0;
    } else if (rate > 0.0) {
      crossing.from = std::max(crossing.from, -at_start[i] / rate);
    } else {
      crossing.to = std::min(crossing.to, -at_start[i] / rate);
    }
  }
  return crossing;
}

bool same_way(const ElementCrossing& a, const ElementCrossing& b) {
  const double shared = std::min(a.to, b.to) - std::max(a.from, b.from);
  return shared > kSameWay * std::min(a.to - a.from, b.to - b.from);
}

}  // namespace

TetCorners corners_of(const TetMesh& mesh, int tet) {
  TetCorners corners;
  for (int i = 0; i < 4; ++i) corners.col(i) = mesh.nodes_m.col(mesh.tets(i, tet));
  return corners;
}

double edge_m(const TetMesh& mesh, int tet) {
  const TetCorners corners = corners_of(mesh, tet);
  return std::cbrt(std::sqrt(2.0) * std::abs((corners.rightCols<3>().colwise() - corners.col(0)).determinant()));
}

std::vector<ElementCrossing> element_crossings(const TetMesh& mesh, const Eigen::Vector3d& from_m,
                                               const Eigen::Vector3d& to_m) {
  std::vector<ElementCrossing> crossings;
  for (int tet = 0; tet < mesh.tet_count(); ++tet) {
    const TetCorners corners = corners_of(mesh, tet);
    if (!boxes_meet(corners, from_m, to_m)) continue;
    const ElementCrossing crossing = clip(tet, barycentric(corners, from_m), barycentric(corners, to_m));
    if ((crossing.to - crossing.from) * (to_m - from_m).norm() < kTouched * longest_edge_m(corners)) continue;
    const bool beside = std::any_of(crossings.begin(), crossings.end(),
                                    [&](const ElementCrossing& other) { return same_way(other, crossing); });
    if (!beside) crossings.push_back(crossing);
  }
  std::sort(crossings.begin(), crossings.end(),
            [](const ElementCrossing& a, const ElementCrossing& b) { return a.from < b.from; });
  return crossings;
}

}  // namespace soft_robot_lab
