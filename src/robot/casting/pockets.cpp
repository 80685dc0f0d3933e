// SPDX-License-Identifier: BSD-3-Clause
#include "pockets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <utility>

#include <Eigen/Geometry>

namespace soft_robot_lab {
namespace {

constexpr int kCells = 512;
constexpr double kOpen = 1e9;  // height of a cell with no robot above it

struct HeightMap {
  Eigen::Matrix3d frame;  // columns: across, across, direction
  Eigen::Vector3d low_m;  // in that frame
  double cell_m = 0;
  Eigen::ArrayXXd height_m;  // of the robot's lowest skin; with an open border

  double cell_area_m2() const { return cell_m * cell_m; }
  // Skin of the robot that lies higher than one can get out level from. A hole through the robot is none.
  bool is_roof(Eigen::Index i, Eigen::Index j, const Eigen::ArrayXXd& level, double least_depth_m) const {
    return height_m(i, j) < kOpen && height_m(i, j) - level(i, j) >= least_depth_m;
  }
  Eigen::Vector3d position_m(Eigen::Index i, Eigen::Index j) const {
    const Eigen::Vector3d local(low_m.x() + (static_cast<double>(i) - 0.5) * cell_m,
                                low_m.y() + (static_cast<double>(j) - 0.5) * cell_m, height_m(i, j));
    return frame * local;
  }
};

HeightMap look_from_below(const RayTree& tree, const Eigen::Vector3d& direction) {
  HeightMap map;
  map.frame = frame_along(direction);
  const Eigen::Matrix3Xd local = map.frame.transpose() * tree.surface().vertices_m;
  map.low_m = local.rowwise().minCoeff();
  const Eigen::Vector3d size = local.rowwise().maxCoeff() - map.low_m;
  map.cell_m = std::max(size.x(), size.y()) / kCells;
  const auto cells = [&](double length) { return static_cast<Eigen::Index>(std::ceil(length / map.cell_m)) + 2; };
  map.height_m.setConstant(cells(size.x()), cells(size.y()), kOpen);
  const double below = map.low_m.z() - 0.01 * tree.surface().size_m();
  for (Eigen::Index i = 1; i + 1 < map.height_m.rows(); ++i) {
    for (Eigen::Index j = 1; j + 1 < map.height_m.cols(); ++j) {
      Eigen::Vector3d start = map.frame.transpose() * map.position_m(i, j);
      start.z() = below;
      const auto hit = tree.first_hit(map.frame * start, direction, 0);
      if (hit) map.height_m(i, j) = below + hit->distance_m;
    }
  }
  return map;
}

template <typename Visit>
void for_neighbours(const Eigen::ArrayXXd& map, Eigen::Index i, Eigen::Index j, const Visit& visit) {
  constexpr std::array<std::array<int, 2>, 4> kSteps{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
  for (const auto& step : kSteps) {
    const Eigen::Index x = i + step[0], y = j + step[1];
    if (x >= 0 && y >= 0 && x < map.rows() && y < map.cols()) visit(x, y);
  }
}

// How high one can be at each cell and still get out level through the mould: the widest way, found from outside.
Eigen::ArrayXXd levels_with_a_way_out(const HeightMap& map) {
  using Cell = std::pair<double, std::pair<Eigen::Index, Eigen::Index>>;
  Eigen::ArrayXXd level = Eigen::ArrayXXd::Constant(map.height_m.rows(), map.height_m.cols(), -kOpen);
  std::priority_queue<Cell> open;
  level(0, 0) = kOpen;
  open.push({kOpen, {0, 0}});
  while (!open.empty()) {
    const auto [height, cell] = open.top();
    open.pop();
    if (height < level(cell.first, cell.second)) continue;
    for_neighbours(map.height_m, cell.first, cell.second, [&, at = height](Eigen::Index x, Eigen::Index y) {
      const double reached = std::min(at, map.height_m(x, y));
      if (reached <= level(x, y)) return;
      level(x, y) = reached;
      open.push({reached, {x, y}});
    });
  }
  return level;
}

// The largest circle in a set of cells, by two sweeps of a chamfer distance (Borgefors 1986).
struct Circle {
  double diameter_m;
  Eigen::Vector3d middle_m;
};

Circle widest(const std::vector<std::pair<Eigen::Index, Eigen::Index>>& cells, const HeightMap& map) {
  Eigen::ArrayXXd distance = Eigen::ArrayXXd::Zero(map.height_m.rows(), map.height_m.cols());
  for (const auto& [i, j] : cells) distance(i, j) = kOpen;
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
  return {(2 * most - 1) * map.cell_m, map.position_m(row, column)};
}

Pocket collect(const HeightMap& map, const Eigen::ArrayXXd& level, double least_depth_m, Eigen::ArrayXXi& seen,
               Eigen::Index i, Eigen::Index j) {
  std::vector<std::pair<Eigen::Index, Eigen::Index>> cells{{i, j}};
  Pocket pocket;
  seen(i, j) = 1;
  for (size_t next = 0; next < cells.size(); ++next) {
    const auto [x, y] = cells[next];
    const double depth = map.height_m(x, y) - level(x, y);
    pocket.roof_area_m2 += map.cell_area_m2();
    pocket.depth_m = std::max(pocket.depth_m, depth);
    for_neighbours(map.height_m, x, y, [&](Eigen::Index u, Eigen::Index v) {
      if (seen(u, v) != 0 || !map.is_roof(u, v, level, least_depth_m)) return;
      seen(u, v) = 1;
      cells.emplace_back(u, v);
    });
  }
  const Circle circle = widest(cells, map);
  pocket.width_m = circle.diameter_m;
  pocket.at_m = circle.middle_m;
  return pocket;
}

}  // namespace

Pockets find_pockets(const RayTree& tree, const Eigen::Vector3d& direction, double least_depth_m) {
  const HeightMap map = look_from_below(tree, direction);
  const Eigen::ArrayXXd level = levels_with_a_way_out(map);
  Eigen::ArrayXXi seen = Eigen::ArrayXXi::Zero(level.rows(), level.cols());
  Pockets result;
  double roofs_m2 = 0;
  for (Eigen::Index i = 0; i < level.rows(); ++i) {
    for (Eigen::Index j = 0; j < level.cols(); ++j) {
      if (map.height_m(i, j) < kOpen) result.footprint_m2 += map.cell_area_m2();
      if (seen(i, j) != 0 || !map.is_roof(i, j, level, least_depth_m)) continue;
      result.pockets.push_back(collect(map, level, least_depth_m, seen, i, j));
      roofs_m2 += result.pockets.back().roof_area_m2;
    }
  }
  result.wall_area_m2 = result.footprint_m2 - roofs_m2;
  const auto larger = [](const Pocket& a, const Pocket& b) { return a.roof_area_m2 > b.roof_area_m2; };
  std::sort(result.pockets.begin(), result.pockets.end(), larger);
  return result;
}

double suction_n(const Pocket& pocket) { return kAtmosphere_pa * pocket.roof_area_m2; }

}  // namespace soft_robot_lab
