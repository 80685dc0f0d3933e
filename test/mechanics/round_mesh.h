// SPDX-License-Identifier: BSD-3-Clause
// Structured test meshes of round bodies: the part of a box mesh between its diagonals, mapped with the nodes in the
// middle of its edges, so that round skin is curved.
#pragma once

#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "mechanics/box_mesh.h"

namespace soft_robot_lab {

using PlaceMap = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;

// The tetrahedra whose middles are kept; with `mirrored` also their images at y = 0.
inline TetMesh mapped_part(const TetMesh& whole, const std::function<bool(const Eigen::Vector3d&)>& kept,
                           const PlaceMap& map, bool mirrored) {
  const auto count = static_cast<std::size_t>(whole.nodes_m.cols());
  std::vector<int> places(count, -1), images(count, -1);
  std::vector<Eigen::Vector3d> nodes;
  std::vector<Eigen::VectorXi> tets;
  const auto place_of = [&](int node, bool image) {
    Eigen::Vector3d at = map(whole.nodes_m.col(node));
    const bool own_image = std::abs(at.y()) < 1e-12;
    int& place = (image && !own_image ? images : places)[static_cast<std::size_t>(node)];
    if (place >= 0) return place;
    if (image) at.y() = -at.y();
    nodes.push_back(at);
    return place = static_cast<int>(nodes.size()) - 1;
  };
  for (Eigen::Index tet = 0; tet < whole.tets.cols(); ++tet) {
    const Eigen::VectorXi of = whole.tets.col(tet);
    if (!kept(whole.nodes_m(Eigen::all, of.head<4>()).rowwise().mean())) continue;
    for (const bool image : {false, true})
      if (!image || mirrored) tets.push_back(of.unaryExpr([&](int node) { return place_of(node, image); }));
  }
  TetMesh mesh;
  mesh.nodes_m.resize(3, static_cast<Eigen::Index>(nodes.size()));
  for (std::size_t i = 0; i < nodes.size(); ++i) mesh.nodes_m.col(static_cast<Eigen::Index>(i)) = nodes[i];
  mesh.tets.resize(whole.tets.rows(), static_cast<Eigen::Index>(tets.size()));
  for (std::size_t i = 0; i < tets.size(); ++i) {
    Eigen::VectorXi& tet = tets[i];
    Eigen::Matrix3d edges;
    for (int k = 0; k < 3; ++k)
      edges.col(k) = nodes[static_cast<std::size_t>(tet[k + 1])] - nodes[static_cast<std::size_t>(tet[0])];
    if (edges.determinant() < 0.0)
      for (const auto& [one, other] : {std::pair(1, 2), {4, 6}, {8, 9}}) std::swap(tet[one], tet[other]);
    mesh.tets.col(static_cast<Eigen::Index>(i)) = tet;
  }
  return mesh;
}

// x, z >= 0, with its middle at the origin and `elements` along a radius.
inline TetMesh quarter_ball(double radius_m, int elements) {
  return mapped_part(
      box_mesh(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones(), Eigen::Vector3i::Constant(elements)),
      [](const Eigen::Vector3d& middle) { return middle.x() > middle.y() && middle.y() > middle.z(); },
      [radius_m](const Eigen::Vector3d& p) -> Eigen::Vector3d {
        const Eigen::Vector3d way(p.z(), p.x() - p.y(), p.y() - p.z());
        return radius_m * p.x() * way.stableNormalized();
      },
      true);
}

// x, z >= 0, from y = 0 up.
inline TetMesh quarter_disc(double radius_m, double height_m, const Eigen::Vector2i& elements) {
  return mapped_part(
      box_mesh(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones(), {elements.x(), elements.y(), elements.x()}),
      [](const Eigen::Vector3d& middle) { return middle.x() > middle.z(); },
      [=](const Eigen::Vector3d& p) -> Eigen::Vector3d {
        const Eigen::Vector3d way(p.x() - p.z(), 0.0, p.z());
        return radius_m * p.x() * way.stableNormalized() + height_m * p.y() * Eigen::Vector3d::UnitY();
      },
      false);
}

}  // namespace soft_robot_lab
