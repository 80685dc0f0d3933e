// SPDX-License-Identifier: BSD-3-Clause
// Structured test meshes: a box of cells, each cut into six tetrahedra.
#pragma once

#include <array>

#include "soft_robot_lab/mechanics/tet_mesh.h"

namespace soft_robot_lab {

inline TetMesh box_mesh(const Eigen::Vector3d& min_m, const Eigen::Vector3d& max_m, const Eigen::Vector3i& cells,
                        bool quadratic = true) {
  TetMesh mesh;
  const Eigen::Vector3i points = cells.array() + 1;
  const auto index = [&](int i, int j, int k) { return (i * points.y() + j) * points.z() + k; };
  mesh.nodes_m.resize(3, points.prod());
  for (int i = 0; i < points.x(); ++i)
    for (int j = 0; j < points.y(); ++j)
      for (int k = 0; k < points.z(); ++k)
        mesh.nodes_m.col(index(i, j, k)) =
            min_m.array() + (max_m - min_m).array() * Eigen::Array3d(i, j, k) / cells.array().cast<double>();
  // The six tetrahedra around the diagonal from corner 000 to corner 111: one per order of the axes.
  constexpr std::array<std::array<int, 3>, 6> kOrders{
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
  mesh.tets.resize(4, 6 * cells.prod());
  int tet = 0;
  for (int i = 0; i < cells.x(); ++i) {
    for (int j = 0; j < cells.y(); ++j) {
      for (int k = 0; k < cells.z(); ++k) {
        for (std::size_t o = 0; o < kOrders.size(); ++o, ++tet) {
          Eigen::Vector3i corner(i, j, k);
          std::array<int, 4> nodes{index(i, j, k)};
          for (int step = 0; step < 3; ++step) {
            ++corner[kOrders[o][step]];
            nodes[step + 1] = index(corner.x(), corner.y(), corner.z());
          }
          if (o >= 3) std::swap(nodes[1], nodes[2]);  // the odd orders turn the other way
          for (int c = 0; c < 4; ++c) mesh.tets(c, tet) = nodes[c];
        }
      }
    }
  }
  return quadratic ? make_quadratic(mesh) : mesh;
}

}  // namespace soft_robot_lab
