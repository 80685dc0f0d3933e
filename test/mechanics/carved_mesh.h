// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "mechanics/box_mesh.h"

namespace soft_robot_lab {

// The cells of a box whose middles are kept.
inline TetMesh carved(const Eigen::Vector3d& min_m, const Eigen::Vector3d& max_m, const Eigen::Vector3i& cells,
                      const std::function<bool(const Eigen::Vector3d&)>& kept) {
  const TetMesh whole = box_mesh(min_m, max_m, cells, false);
  std::vector<int> place(static_cast<std::size_t>(whole.nodes_m.cols()), -1), tets;
  TetMesh mesh;
  std::vector<int> nodes;
  for (int tet = 0; tet < whole.tets.cols(); ++tet) {
    const int first = 6 * (tet / 6);  // the first and last corner of a cell's first tetrahedron are opposite
    const Eigen::Vector3d middle_m =
        0.5 * (whole.nodes_m.col(whole.tets(0, first)) + whole.nodes_m.col(whole.tets(3, first)));
    if (!kept(middle_m)) continue;
    tets.push_back(tet);
    for (int corner = 0; corner < 4; ++corner) {
      int& at = place[static_cast<std::size_t>(whole.tets(corner, tet))];
      if (at >= 0) continue;
      at = static_cast<int>(nodes.size());
      nodes.push_back(whole.tets(corner, tet));
    }
  }
  mesh.nodes_m = whole.nodes_m(Eigen::all, nodes);
  mesh.tets = whole.tets(Eigen::all, tets).unaryExpr([&](int node) { return place[static_cast<std::size_t>(node)]; });
  return make_quadratic(mesh);
}

}  // namespace soft_robot_lab
