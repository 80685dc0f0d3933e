// SPDX-License-Identifier: BSD-3-Clause
#include "pockets.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

#include <Eigen/Geometry>

#include "height_map.h"

namespace soft_robot_lab {
namespace {

const double kLooksDown = -std::cos(M_PI / 4);  // of a normal along the direction

// How high one can be at each cell and still get out level through the mould: the widest way, found from outside.
Eigen::ArrayXXd levels_with_a_way_out(const HeightMap& map) {
  Eigen::ArrayXXd level = Eigen::ArrayXXd::Constant(map.height_m.rows(), map.height_m.cols(), -kOpen);
  std::priority_queue<std::pair<double, Cell>> open;
  for (Eigen::Index i = 0; i < level.rows(); ++i)
    for (Eigen::Index j = 0; j < level.cols(); ++j)
      if (map.is_outside(i, j)) level(i, j) = kOpen, open.push({kOpen, {i, j}});
  while (!open.empty()) {
    const auto [height, cell] = open.top();
    open.pop();
    if (height < level(cell.first, cell.second)) continue;
    for_neighbours<4>(map, cell, [&, at = height](Eigen::Index x, Eigen::Index y) {
      const double reached = std::min(at, map.height_m(x, y));
      if (reached <= level(x, y)) return;
      level(x, y) = reached;
      open.push({reached, {x, y}});
    });
  }
  return level;
}

// Calls `visit` with each connected set of the cells for which `belongs` is true.
template <int count, typename Belongs, typename Visit>
void for_each_part(const HeightMap& map, const std::vector<Cell>& cells, CellFlags& seen, const Belongs& belongs,
                   const Visit& visit) {
  for (const Cell& cell : cells)
    if (!seen(cell.first, cell.second) && belongs(cell.first, cell.second))
      visit(connected_cells<count>(map, cell, seen, belongs));
}

std::vector<Cell> all_cells(const HeightMap& map) {
  std::vector<Cell> cells;
  for (Eigen::Index i = 0; i < map.height_m.rows(); ++i)
    for (Eigen::Index j = 0; j < map.height_m.cols(); ++j) cells.emplace_back(i, j);
  return cells;
}

CellFlags none_of(const HeightMap& map) { return CellFlags::Constant(map.height_m.rows(), map.height_m.cols(), false); }

// --- roofs ---

// Cells that cells at least as high join to a hole through the robot: air may come down along the core's wall.
CellFlags beside_through_holes(const HeightMap& map, std::vector<Cell> cells) {
  const auto number = [&](const Cell& cell) { return cell.first * map.height_m.cols() + cell.second; };
  std::vector<Eigen::Index> parent(static_cast<size_t>(map.height_m.size()), -1);
  CellFlags joined = none_of(map), through = map.through;
  const auto root = [&](Eigen::Index at) {
    while (parent[static_cast<size_t>(at)] != at) {
      auto& up = parent[static_cast<size_t>(at)];
      at = up = parent[static_cast<size_t>(up)];
    }
    return at;
  };
  const auto is_through = [&](Eigen::Index at) -> bool& {
    return through(at / map.height_m.cols(), at % map.height_m.cols());
  };
  std::stable_sort(cells.begin(), cells.end(), [&](const Cell& a, const Cell& b) {
    return map.height_m(a.first, a.second) > map.height_m(b.first, b.second);
  });
  for (const Cell& cell : cells) {
    parent[static_cast<size_t>(number(cell))] = number(cell);
    for_neighbours<8>(map, cell, [&](Eigen::Index x, Eigen::Index y) {
      if (parent[static_cast<size_t>(number({x, y}))] < 0) return;
      const Eigen::Index other = root(number({x, y})), own = root(number(cell));
      if (is_through(own)) is_through(other) = true;
      parent[static_cast<size_t>(own)] = other;
    });
    joined(cell.first, cell.second) = is_through(root(number(cell)));
  }
  return joined;
}

void add_air_traps(const HeightMap& map, const std::vector<Cell>& in_cores, const CellFlags& is_core, Pockets& result) {
  const CellFlags beside = beside_through_holes(map, in_cores);
  const auto is_air_trap = [&](Eigen::Index i, Eigen::Index j) {
    return is_core(i, j) && map.is_skin(i, j) && (!beside(i, j) || map.facing(i, j) < kLooksDown);
  };
  CellFlags seen = none_of(map);
  for_each_part<4>(map, in_cores, seen, is_air_trap, [&](const std::vector<Cell>& roof) {
    const auto [i, j] = widest_circle(map, roof).middle;
    result.pockets.push_back(
        {static_cast<double>(roof.size()) * map.cell_area_m2(), map.position_m(i, j, map.height_m(i, j))});
    result.wall_area_m2 -= result.pockets.back().roof_area_m2;
  });
}

// --- cores ---

// From a place between walls, level, to the nearest of them; infinite where there is none.
double room_m(const RayTree& tree, const Eigen::Matrix3d& frame, const Eigen::Vector3d& position_m) {
  constexpr int kWays = 36;
  double least = INFINITY;
  for (int k = 0; k < kWays; ++k) {
    const double turn = 2 * M_PI * k / kWays;
    const auto hit = tree.first_hit(position_m, std::cos(turn) * frame.col(0) + std::sin(turn) * frame.col(1), 0);
    if (hit) least = std::min(least, hit->distance_m);
  }
  return least;
}

// Of the largest circle around a place near its middle, which is moved there.
double width_m(const RayTree& tree, const Eigen::Matrix3d& frame, Eigen::Vector3d& position_m) {
  constexpr double kFine = 0.003;
  double room = room_m(tree, frame, position_m);
  if (!std::isfinite(room)) return INFINITY;
  for (double step = room / 2; step > kFine * room;) {
    bool moved = false;
    for (int k = 0; k < 8; ++k) {
      const double turn = 2 * M_PI * k / 8;
      const Eigen::Vector3d next =
          position_m + std::min(step, room / 2) * (std::cos(turn) * frame.col(0) + std::sin(turn) * frame.col(1));
      const double found = room_m(tree, frame, next);
      if (!(found > room * (1 + 1e-6)) || !std::isfinite(found)) continue;
      room = found, position_m = next, moved = true;
    }
    if (!moved) step /= 2;
  }
  return 2 * room;
}

class SlimmestPart {
 public:
  SlimmestPart(const RayTree& tree, const HeightMap& map, double foot_m) : tree_(tree), map_(map), foot_m_(foot_m) {}

  // Of one core's cells above a height. Its width is only measured where it could be the slimmest.
  void offer(const std::vector<Cell>& cells, double height_m, bool is_foot) {
    Core core;
    double top_m = -kOpen;
    for (const auto& [i, j] : cells) {
      top_m = std::max(top_m, map_.height_m(i, j));
      core.through = core.through || map_.through(i, j);
    }
    core.height_m = top_m - (is_foot ? foot_m_ : height_m);
    const CellCircle circle = widest_circle(map_, cells);
    constexpr double kUnsure = 4;  // cells
    if (core.height_m < best_.aspect() * (circle.diameter_m - kUnsure * map_.cell_m)) return;
    core.at_m = map_.position_m(circle.middle.first, circle.middle.second, height_m);
    core.width_m = width_m(tree_, map_.frame, core.at_m);
    core.at_m += (top_m - height_m) * map_.frame.col(2);
    if (core.aspect() > best_.aspect()) best_ = core;
  }

  const Core& best() const { return best_; }

 private:
  const RayTree& tree_;
  const HeightMap& map_;
  double foot_m_;
  Core best_;
};

Core slimmest_part(const RayTree& tree, const HeightMap& map, const std::vector<Cell>& cells, double foot_m,
                   CellFlags& seen) {
  constexpr int kHeights = 64;
  constexpr double kJustAbove = 0.02;  // of a step: walls that end at the foot are met
  double top_m = foot_m;
  for (const auto& [i, j] : cells) top_m = std::max(top_m, map.height_m(i, j));
  SlimmestPart slimmest(tree, map, foot_m);
  const auto any = [](Eigen::Index, Eigen::Index) { return true; };  // what is not of this core is seen already
  for (int k = 0; k < kHeights; ++k) {
    const double height_m = foot_m + (k + kJustAbove) / kHeights * (top_m - foot_m);
    for (const auto& [i, j] : cells) seen(i, j) = map.height_m(i, j) < height_m;
    for_each_part<8>(map, cells, seen, any,
                     [&](const std::vector<Cell>& part) { slimmest.offer(part, height_m, k == 0); });
  }
  return slimmest.best();
}

void add_cores(const RayTree& tree, const HeightMap& map, const std::vector<Cell>& in_cores, const CellFlags& is_core,
               const Eigen::ArrayXXd& level, Pockets& result) {
  CellFlags seen = none_of(map), not_here = CellFlags::Constant(seen.rows(), seen.cols(), true);
  const auto belongs = [&](Eigen::Index i, Eigen::Index j) { return is_core(i, j); };
  for_each_part<8>(map, in_cores, seen, belongs, [&](const std::vector<Cell>& cells) {
    const double foot_m = level(cells[0].first, cells[0].second);
    const Core core = slimmest_part(tree, map, cells, foot_m, not_here);
    for (const auto& [i, j] : cells) not_here(i, j) = true;
    if (core.aspect() > 0) result.cores.push_back(core);
  });
  std::sort(result.cores.begin(), result.cores.end(),
            [](const Core& a, const Core& b) { return a.aspect() > b.aspect(); });
}

}  // namespace

Pockets find_pockets(const RayTree& tree, const Eigen::Vector3d& direction, double least_depth_m, double top_m) {
  HeightMap map = look_from_below(tree, direction);
  map.height_m = (map.height_m < kOpen).select(map.height_m.min(top_m), map.height_m);
  const Eigen::ArrayXXd level = levels_with_a_way_out(map);
  const CellFlags is_core = map.height_m < kOpen && map.height_m - level >= least_depth_m;
  std::vector<Cell> in_cores;
  Pockets result;
  for (const Cell& cell : all_cells(map)) {
    if (map.is_skin(cell.first, cell.second)) result.footprint_m2 += map.cell_area_m2();
    if (is_core(cell.first, cell.second)) in_cores.push_back(cell);
  }
  result.wall_area_m2 = result.footprint_m2;
  add_air_traps(map, in_cores, is_core, result);
  add_cores(tree, map, in_cores, is_core, level, result);
  const auto larger = [](const Pocket& a, const Pocket& b) { return a.roof_area_m2 > b.roof_area_m2; };
  std::sort(result.pockets.begin(), result.pockets.end(), larger);
  return result;
}

double suction_n(const Pocket& pocket) { return kAtmosphere_pa * pocket.roof_area_m2; }

}  // namespace soft_robot_lab
