// SPDX-License-Identifier: BSD-3-Clause
// A robot seen from below, against the direction in which it leaves its mould: the heights of its lowest skin.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "ray_tree.h"

namespace soft_robot_lab {

constexpr double kOpen = 1e9;  // height of a cell beside the robot

using Cell = std::pair<Eigen::Index, Eigen::Index>;
using CellFlags = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>;

struct HeightMap {
  Eigen::Matrix3d frame;     // columns: across, across, direction
  Eigen::Vector3d low_m;     // in that frame
  double cell_m = 0;         // with a border of one open cell
  Eigen::ArrayXXd height_m;  // of the lowest skin; of a hole through the robot: of the highest skin beside it
  Eigen::ArrayXXd facing;    // cosine between that skin's normal and the direction: -1 looks down; 0: no skin
  CellFlags through;         // holes through the robot

  bool is_outside(Eigen::Index i, Eigen::Index j) const { return height_m(i, j) >= kOpen; }
  bool is_skin(Eigen::Index i, Eigen::Index j) const { return !is_outside(i, j) && !through(i, j); }
  double cell_area_m2() const { return cell_m * cell_m; }
  Eigen::Vector3d position_m(Eigen::Index i, Eigen::Index j, double height_m) const;
};

// 512 cells along the longer side. Holes thinner than a cell may be missed.
HeightMap look_from_below(const RayTree& tree, const Eigen::Vector3d& direction);

// Calls `visit` for the first `count` neighbours of a cell: 4 that share a side, 8 with those that share a corner.
template <int count, typename Visit>
void for_neighbours(const HeightMap& map, const Cell& cell, const Visit& visit) {
  constexpr std::array<std::array<int, 2>, 8> kSteps{
      {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {1, -1}, {-1, 1}, {-1, -1}}};
  for (size_t k = 0; k < count; ++k) {
    const Eigen::Index x = cell.first + kSteps[k][0], y = cell.second + kSteps[k][1];
    if (x >= 0 && y >= 0 && x < map.height_m.rows() && y < map.height_m.cols()) visit(x, y);
  }
}

// The cells that neighbours lead to for which `belongs` is true, from one that belongs. They are marked in `seen`.
template <int count, typename Belongs>
std::vector<Cell> connected_cells(const HeightMap& map, const Cell& seed, CellFlags& seen, const Belongs& belongs) {
  std::vector<Cell> cells{seed};
  seen(seed.first, seed.second) = true;
  for (size_t next = 0; next < cells.size(); ++next) {
    const Cell cell = cells[next];
    for_neighbours<count>(map, cell, [&](Eigen::Index x, Eigen::Index y) {
      if (seen(x, y) || !belongs(x, y)) return;
      seen(x, y) = true;
      cells.emplace_back(x, y);
    });
  }
  return cells;
}

// The largest circle in a set of cells, by two sweeps of a chamfer distance (Borgefors 1986).
struct CellCircle {
  double diameter_m = 0;
  Cell middle;
};
CellCircle widest_circle(const HeightMap& map, const std::vector<Cell>& cells);

}  // namespace soft_robot_lab
