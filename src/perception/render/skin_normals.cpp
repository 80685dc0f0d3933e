// SPDX-License-Identifier: BSD-3-Clause
#include "skin_normals.h"

#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>

namespace soft_robot_lab {
namespace {

const double sharp_cosine = std::cos(35.0 * M_PI / 180);

// Twice the area long.
Eigen::Matrix3Xd face_normals(const Eigen::Matrix3Xd& vertices_m, const Eigen::Matrix3Xi& triangles) {
  Eigen::Matrix3Xd normals(3, triangles.cols());
  for (int t = 0; t < triangles.cols(); ++t) {
    const Eigen::Vector3d a = vertices_m.col(triangles(0, t));
    normals.col(t) = (vertices_m.col(triangles(1, t)) - a).cross(Eigen::Vector3d(vertices_m.col(triangles(2, t)) - a));
  }
  return normals;
}

// Sets that are joined two by two.
struct JoinedSets {
  std::vector<int> parents;
  explicit JoinedSets(int count) : parents(static_cast<std::size_t>(count)) {
    std::iota(parents.begin(), parents.end(), 0);
  }
  int root(int item) {
    while (parents[static_cast<std::size_t>(item)] != item) item = parents[static_cast<std::size_t>(item)];
    return item;
  }
  void join(int a, int b) { parents[static_cast<std::size_t>(root(a))] = root(b); }
};

}  // namespace

SkinNormals::SkinNormals(const Eigen::Matrix3Xd& rest_m, const Eigen::Matrix3Xi& triangles)
    : triangles_(triangles), corner_group_(3, triangles.cols()) {
  const int count = static_cast<int>(triangles.cols());
  const Eigen::Matrix3Xd normals = face_normals(rest_m, triangles);
  // Corners at one vertex belong together where their triangles meet in a smooth edge.
  JoinedSets corners(3 * count);
  std::map<std::pair<int, int>, std::pair<int, int>> first_side;  // edge from-to: triangle, corner at its start
  for (int t = 0; t < count; ++t)
    for (int k = 0; k < 3; ++k) first_side[{triangles(k, t), triangles((k + 1) % 3, t)}] = {t, k};
  for (const auto& [edge, side] : first_side) {
    const auto other = first_side.find({edge.second, edge.first});
    if (other == first_side.end() || edge.first > edge.second) continue;
    const auto& [t, k] = side;
    const auto& [s, l] = other->second;
    if (normals.col(t).dot(normals.col(s)) < sharp_cosine * normals.col(t).norm() * normals.col(s).norm()) continue;
    corners.join(3 * t + k, 3 * s + (l + 1) % 3);
    corners.join(3 * t + (k + 1) % 3, 3 * s + l);
  }
  std::map<int, int> groups;
  for (int t = 0; t < count; ++t)
    for (int k = 0; k < 3; ++k)
      corner_group_(k, t) = groups.emplace(corners.root(3 * t + k), static_cast<int>(groups.size())).first->second;
  normals_.resize(3, static_cast<Eigen::Index>(groups.size()));
  update(rest_m);
}

void SkinNormals::update(const Eigen::Matrix3Xd& vertices_m) {
  face_normals_ = face_normals(vertices_m, triangles_).cast<float>();
  normals_.setZero();
  for (int t = 0; t < triangles_.cols(); ++t)
    for (int k = 0; k < 3; ++k) normals_.col(corner_group_(k, t)) += face_normals_.col(t);  // larger ones weigh more
  normals_.colwise().normalize();
  face_normals_.colwise().normalize();
}

Eigen::Vector3f SkinNormals::at(int triangle, float u, float v) const {
  const auto group = corner_group_.col(triangle);
  return ((1 - u - v) * normals_.col(group(0)) + u * normals_.col(group(1)) + v * normals_.col(group(2))).normalized();
}

}  // namespace soft_robot_lab
