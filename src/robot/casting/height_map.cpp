// SPDX-License-Identifier: BSD-3-Clause
#include "height_map.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace soft_robot_lab {
namespace {

constexpr int kCells = 512;

HeightMap empty_map(const Surface& surface, const Eigen::Vector3d& direction) {
  HeightMap map;
  map.frame = frame_along(direction);
  const Eigen::Matrix3Xd local = map.frame.transpose() * surface.vertices_m;
  map.low_m = local.rowwise().minCoeff();
  const Eigen::Vector3d size = local.rowwise().maxCoeff() - map.low_m;
  map.cell_m = std::max(size.x(), size.y()) / kCells;
  const auto cells = [&](double length) { return static_cast<Eigen::Index>(std::ceil(length / map.cell_m)) + 2; };
  map.height_m.setConstant(cells(size.x()), cells(size.y()), kOpen);
  map.facing.setZero(map.height_m.rows(), map.height_m.cols());
  map.through.setConstant(map.height_m.rows(), map.height_m.cols(), false);
  return map;
}

void look(const RayTree& tree, HeightMap& map) {
  const Eigen::Vector3d up = map.frame.col(2);
  const double below = map.low_m.z() - 0.01 * tree.size_m();
  for (Eigen::Index i = 1; i + 1 < map.height_m.rows(); ++i) {
    for (Eigen::Index j = 1; j + 1 < map.height_m.cols(); ++j) {
      const auto hit = tree.first_hit(map.position_m(i, j, below), up, 0);
      if (!hit) continue;
      map.height_m(i, j) = below + hit->distance_m;
      map.facing(i, j) = tree.surface().true_normals.col(hit->triangle).dot(up);
    }
  }
}

// Of the skin beside open cells, seen from above.
double highest_beside(const RayTree& tree, const HeightMap& map, const std::vector<Cell>& cells) {
  const double above = map.low_m.z() + 2 * tree.size_m();
  double highest = map.low_m.z();
  for (const Cell& cell : cells) {
    for_neighbours<8>(map, cell, [&](Eigen::Index x, Eigen::Index y) {
      if (map.is_outside(x, y)) return;
      const auto hit = tree.first_hit(map.position_m(x, y, above), -map.frame.col(2), 0);
      if (hit) highest = std::max(highest, above - hit->distance_m);
    });
  }
  return highest;
}

// Open cells that no open cells join to the border.
void find_through_holes(const RayTree& tree, HeightMap& map) {
  CellFlags seen = CellFlags::Constant(map.height_m.rows(), map.height_m.cols(), false);
  const auto is_open = [&](Eigen::Index i, Eigen::Index j) { return map.is_outside(i, j); };
  connected_cells<8>(map, {0, 0}, seen, is_open);
  for (Eigen::Index i = 0; i < map.height_m.rows(); ++i) {
    for (Eigen::Index j = 0; j < map.height_m.cols(); ++j) {
      if (seen(i, j) || !map.is_outside(i, j)) continue;
      const std::vector<Cell> hole = connected_cells<8>(map, {i, j}, seen, is_open);
      const double top_m = highest_beside(tree, map, hole);
      for (const auto& [x, y] : hole) map.height_m(x, y) = top_m, map.through(x, y) = true;
    }
  }
}

}  // namespace

Eigen::Vector3d HeightMap::position_m(Eigen::Index i, Eigen::Index j, double at_height_m) const {
  return frame * Eigen::Vector3d(low_m.x() + (static_cast<double>(i) - 0.5) * cell_m,
                                 low_m.y() + (static_cast<double>(j) - 0.5) * cell_m, at_height_m);
}

HeightMap look_from_below(const RayTree& tree, const Eigen::Vector3d& direction) {
  HeightMap map = empty_map(tree.surface(), direction);
  look(tree, map);
  find_through_holes(tree, map);
  return map;
}

CellCircle widest_circle(const HeightMap& map, const std::vector<Cell>& cells) {
  Cell low = cells[0], high = cells[0];
  for (const auto& [i, j] : cells) {
    low = {std::min(low.first, i - 1), std::min(low.second, j - 1)};
    high = {std::max(high.first, i + 1), std::max(high.second, j + 1)};
  }
  Eigen::ArrayXXd distance = Eigen::ArrayXXd::Zero(high.first - low.first + 1, high.second - low.second + 1);
  for (const auto& [i, j] : cells) distance(i - low.first, j - low.second) = kOpen;
  const auto relax = [&](Eigen::Index i, Eigen::Index j, int sign) {
    const auto via = [&](Eigen::Index x, Eigen::Index y, double step) {
      distance(i, j) = std::min(distance(i, j), distance(x, y) + step);
    };
    via(i - sign, j, 1), via(i, j - sign, 1);
    via(i - sign, j - sign, std::sqrt(2.0)), via(i + sign, j - sign, std::sqrt(2.0));
  };
  const Eigen::Index rows = distance.rows() - 1, columns = distance.cols() - 1;
  for (Eigen::Index j = 1; j < columns; ++j)
    for (Eigen::Index i = 1; i < rows; ++i) relax(i, j, 1);
  for (Eigen::Index j = columns - 1; j > 0; --j)
    for (Eigen::Index i = rows - 1; i > 0; --i) relax(i, j, -1);
  Eigen::Index row = 0, column = 0;
  const double most = distance.maxCoeff(&row, &column);
  return {(2 * most - 1) * map.cell_m, {low.first + row, low.second + column}};
}

}  // namespace soft_robot_lab
