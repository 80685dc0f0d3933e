// SPDX-License-Identifier: BSD-3-Clause
#include "lid_plan.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "build_solids.h"
#include "inside_solid.h"
#include "pockets.h"

namespace soft_robot_lab {
namespace {

using Eigen::Vector3d;

constexpr double kBridge_m = 0.003;      // from the rim up to the bridge: room to pour, and to see the level
constexpr double kBar_m = 0.008;         // width of the bridge's bars
constexpr double kLip_m = 0.006;         // how far their ends reach down outside of the base
constexpr double kOutOfTheWay_m = 0.01;  // beyond the robot on all sides
constexpr double kJustBeside_m = 1e-5;
const double kUpright = std::sin(0.1 * M_PI / 180);

bool is_cavity(const Surface& surface, int t) {
  return surface.shell_volumes_m3[static_cast<size_t>(surface.shell[static_cast<size_t>(t)])] < 0;
}

bool touches(const Surface& surface, int t, const Vector3d& direction, double height_m) {
  for (int i = 0; i < 3; ++i)
    if (std::abs(direction.dot(surface.corner(t, i)) - height_m) > 1e-7) return false;
  return true;
}

// Highest and lowest of one cavity.
std::vector<MouldHeights> heights_of_cavities(const Surface& surface, const Vector3d& direction) {
  std::vector<MouldHeights> all(surface.shell_volumes_m3.size(), {INFINITY, -INFINITY});
  for (int t = 0; t < surface.triangle_count(); ++t) {
    if (!is_cavity(surface, t)) continue;
    MouldHeights& heights = all[static_cast<size_t>(surface.shell[static_cast<size_t>(t)])];
    for (int i = 0; i < 3; ++i) {
      heights.floor_m = std::min(heights.floor_m, direction.dot(surface.corner(t, i)));
      heights.top_m = std::max(heights.top_m, direction.dot(surface.corner(t, i)));
    }
  }
  all.erase(std::remove_if(all.begin(), all.end(), [](const auto& h) { return h.top_m < h.floor_m; }), all.end());
  return all;
}

// A core leaves upwards where no silicone of its cavity faces down but its ceiling, which is the lid's.
bool core_leaves(const Surface& surface, const Vector3d& direction, double height_m) {
  double ceiling_m2 = 0;
  for (int t = 0; t < surface.triangle_count(); ++t) {
    if (!is_cavity(surface, t)) continue;
    if (touches(surface, t, direction, height_m)) {
      ceiling_m2 += surface.areas_m2[t];
    } else if (surface.areas_m2[t] > 0 && surface.true_normals.col(t).dot(direction) < -kUpright) {
      return false;
    }
  }
  return ceiling_m2 > 0;
}

// The robot with its cavities filled, and what fills them.
struct Filled {
  Solid outside;
  std::vector<Solid> cores;
};

enum class Takes { cavity, outside };

Takes what_it_takes(const Solid& part, const Surface& surface) {
  for (int t = 0; t < surface.triangle_count(); ++t)
    if (!is_cavity(surface, t) && contains(part, surface.centre(t) + kJustBeside_m * surface.normals.col(t)))
      return Takes::outside;
  return Takes::cavity;
}

Filled fill(const Solid& solid, const Surface& surface) {
  if (solid.kind != Solid::Kind::difference || !has_equations(solid))
    throw NoMould("a lid needs a body.solid of shapes that is a difference: its cavities are what it takes away");
  Filled filled;
  std::vector<Solid> rest{solid.parts[0]};
  for (size_t i = 1; i < solid.parts.size(); ++i)
    (what_it_takes(solid.parts[i], surface) == Takes::cavity ? filled.cores : rest).push_back(solid.parts[i]);
  if (filled.cores.empty()) throw NoMould("no part that body.solid takes away makes its cavity");
  filled.outside = rest.size() > 1 ? combined(Solid::Kind::difference, rest) : rest[0];
  return filled;
}

// --- pieces, in the mould's axes ---

struct Layout {
  Eigen::Matrix3d frame;
  Vector3d low, high;            // of the robot
  Vector3d core_low, core_high;  // of all cavities
  double rim = 0;
  MouldSettings mould;

  Solid box(const Vector3d& from, const Vector3d& to) const { return block(frame, from, to); }
  // All of the robot's surroundings between two heights.
  Solid layer(double from, double to) const {
    const Vector3d wide(kOutOfTheWay_m, kOutOfTheWay_m, 0);
    Vector3d a = low - wide, b = high + wide;
    a.z() = from, b.z() = to;
    return box(a, b);
  }
  Solid below(const Solid& solid) const {
    return combined(Solid::Kind::intersection, {solid, layer(low.z() - kOutOfTheWay_m, rim)});
  }
};

// A bar of the bridge along x (axis 0) or y (1), whose ends stand on the rim and reach down outside.
void add_bar(const Layout& lay, int axis, double middle, std::vector<Solid>& parts) {
  const double wall = lay.mould.wall_m, clearance = lay.mould.clearance_m, above = lay.rim + kBridge_m;
  const auto piece = [&](double from, double to, double bottom, double top) {
    Vector3d a, b;
    a[axis] = from, b[axis] = to;
    a[1 - axis] = middle - kBar_m / 2, b[1 - axis] = middle + kBar_m / 2;
    a.z() = bottom, b.z() = top;
    parts.push_back(lay.box(a, b));
  };
  const double reach = 2 * wall + clearance, low = lay.low[axis], high = lay.high[axis];
  piece(low - reach, high + reach, above, above + wall);
  piece(low - wall, low, lay.rim, above);
  piece(high, high + wall, lay.rim, above);
  piece(low - reach, low - reach + wall, lay.rim - kLip_m, above);
  piece(high + reach - wall, high + reach, lay.rim - kLip_m, above);
}

std::vector<Solid> bridge(const Layout& lay) {
  std::vector<Solid> parts;
  Vector3d low = lay.core_low, high = lay.core_high;
  low.z() = lay.rim + kBridge_m, high.z() = low.z() + lay.mould.wall_m;
  parts.push_back(lay.box(low, high));
  const Vector3d middle = (low + high) / 2;
  add_bar(lay, 0, middle.y(), parts);
  for (const double share : {1.0 / 6, 5.0 / 6}) add_bar(lay, 1, low.x() + share * (high.x() - low.x()), parts);
  return parts;
}

// The cavities below the lid; their upper end again up to the bridge; the bridge; air holes through all.
Solid hanging_core(const Layout& lay, const Filled& filled, const std::vector<AirHole>& holes) {
  std::vector<Solid> parts;
  for (const Solid& core : filled.cores) {
    parts.push_back(lay.below(core));
    Solid neck = combined(Solid::Kind::translate,
                          {combined(Solid::Kind::intersection, {core, lay.layer(lay.rim - kBridge_m, lay.rim)})});
    neck.by_m = kBridge_m * lay.frame.col(2);
    parts.push_back(neck);
  }
  for (const Solid& part : bridge(lay)) parts.push_back(part);
  std::vector<Solid> all{combined(Solid::Kind::union_of, parts)};
  for (const AirHole& hole : holes) all.push_back(round_bar(hole.from_m, hole.to_m, lay.mould.air_hole_radius_m));
  return all.size() > 1 ? combined(Solid::Kind::difference, all) : all[0];
}

// What the core would hold by a vacuum when it is drawn: from each deepest place up through the bridge.
std::vector<AirHole> core_holes(const Layout& lay, const Surface& main, const CastingSettings& settings) {
  const Vector3d up = lay.frame.col(2);
  const double top = lay.rim + kBridge_m + lay.mould.wall_m + kOutOfTheWay_m;
  std::vector<AirHole> holes;
  for (const Pocket& pocket : find_pockets(RayTree(main), -up, settings.notch_radius_m).pockets)
    holes.push_back({pocket.at_m, pocket.at_m + (top - up.dot(pocket.at_m)) * up});
  return holes;
}

MouldPiece piece_of(const Layout& lay, const std::string& name, const Solid& solid, bool turned) {
  MouldPiece piece;
  piece.name = name;
  piece.solid = solid;
  piece.to_print = lay.frame.transpose();
  if (turned) piece.to_print = Vector3d(1, -1, -1).asDiagonal() * piece.to_print;
  const double wall = lay.mould.wall_m;
  piece.size_m = lay.high - lay.low + Vector3d(2 * wall, 2 * wall, wall);
  piece.form_low_m = lay.low;
  piece.form_high_m = lay.high;
  return piece;
}

Layout lay_out(const CastRobotFile& file, const LidCut& cut) {
  const Surface& surface = file.robot.surface;
  Layout lay;
  lay.mould = file.settings.mould;
  const Vector3d size = surface.vertices_m.rowwise().maxCoeff() - surface.vertices_m.rowwise().minCoeff();
  Eigen::Index longest = 0;
  (size - size.cwiseProduct(cut.direction.cwiseAbs())).maxCoeff(&longest);
  const Vector3d along = Vector3d::Unit(longest);
  lay.frame << along, cut.direction.cross(along), cut.direction;
  const Eigen::Matrix3Xd places = lay.frame.transpose() * surface.vertices_m;
  lay.low = places.rowwise().minCoeff();
  lay.high = places.rowwise().maxCoeff();
  lay.core_low.setConstant(INFINITY);
  lay.core_high.setConstant(-INFINITY);
  for (int t = 0; t < surface.triangle_count(); ++t) {
    if (!is_cavity(surface, t)) continue;
    for (int i = 0; i < 3; ++i) {
      lay.core_low = lay.core_low.cwiseMin(places.col(surface.triangles(i, t)));
      lay.core_high = lay.core_high.cwiseMax(places.col(surface.triangles(i, t)));
    }
  }
  lay.rim = cut.height_m;
  return lay;
}

double cavities_m3(const Surface& surface) {
  double volume = 0;
  for (const double shell : surface.shell_volumes_m3) volume -= std::min(0.0, shell);
  return volume;
}

void add_pieces(const Layout& lay, const Filled& filled, const Solid& solid, MouldPlan& plan) {
  const Vector3d wall = Vector3d::Constant(lay.mould.wall_m), beside(wall.x(), wall.y(), 0);
  Vector3d base_high = lay.high + beside, tray_low = lay.low - beside;
  base_high.z() = tray_low.z() = lay.rim;
  const Vector3d base_low = lay.low - wall, tray_high = lay.high + wall;
  MouldPiece base =
      piece_of(lay, "base", combined(Solid::Kind::difference, {lay.box(base_low, base_high), filled.outside}), false);
  MouldPiece core = piece_of(lay, "core", hanging_core(lay, filled, plan.air_holes), true);
  MouldPiece tray =
      piece_of(lay, "lid_tray", combined(Solid::Kind::difference, {lay.box(tray_low, tray_high), solid}), true);
  base.form_high_m.z() = core.form_high_m.z() = tray.form_low_m.z() = lay.rim;
  base.size_m.z() = lay.rim - base_low.z();
  tray.size_m.z() = tray_high.z() - lay.rim;
  core.size_m += 2 * Vector3d(lay.mould.wall_m + lay.mould.clearance_m, lay.mould.wall_m + lay.mould.clearance_m, 0);
  core.size_m.z() = lay.rim + kBridge_m + lay.mould.wall_m - std::min(lay.core_low.z(), lay.rim - kLip_m);
  core.in_block = false;
  plan.pieces = {base, core, tray};
  plan.block_volume_m3 = (base_high - base_low).prod() + (tray_high - tray_low).prod();
}

bool leaves(const Solid& solid, const CastRobotFile& file, const Vector3d& direction) {
  const Surface surface = surface_of_solid(solid, file.robot.surface.size_m(), file.mesher);
  return verify_extraction(CastShape(surface), direction).passed;
}

}  // namespace

std::vector<LidCut> lid_cuts(const Surface& robot) {
  std::vector<LidCut> cuts;
  for (const Vector3d& direction : {Vector3d(1, 0, 0), Vector3d(-1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, -1, 0),
                                    Vector3d(0, 0, 1), Vector3d(0, 0, -1)}) {
    const std::vector<MouldHeights> cavities = heights_of_cavities(robot, direction);
    if (cavities.empty()) return {};
    LidCut cut{direction, cavities[0].top_m, 0};
    const auto ends_there = [&](const MouldHeights& h) { return std::abs(h.top_m - cut.height_m) < 1e-7; };
    if (!std::all_of(cavities.begin(), cavities.end(), ends_there)) continue;
    for (const MouldHeights& h : cavities) cut.depth_m = std::max(cut.depth_m, h.top_m - h.floor_m);
    if (core_leaves(robot, direction, cut.height_m)) cuts.push_back(cut);
  }
  const auto less_deep = [](const LidCut& a, const LidCut& b) { return a.depth_m < b.depth_m - 1e-9; };
  std::stable_sort(cuts.begin(), cuts.end(), less_deep);
  return cuts;
}

MouldPlan plan_lid(const CastRobotFile& file, const Solid& solid) {
  const Filled filled = fill(solid, file.robot.surface);
  for (const LidCut& cut : lid_cuts(file.robot.surface)) {
    const Layout lay = lay_out(file, cut);
    const Solid lid = combined(Solid::Kind::intersection, {solid, lay.layer(lay.rim, lay.high.z() + kOutOfTheWay_m)});
    if (!leaves(lay.below(filled.outside), file, cut.direction) || !leaves(lid, file, -cut.direction)) continue;
    MouldPlan plan;
    plan.lid = true;
    plan.cast = solid;
    plan.direction = cut.direction;
    plan.frame = lay.frame;
    plan.low_m = lay.low;
    plan.high_m = lay.high;
    plan.rim_m = lay.rim;
    const Surface main = surface_of_solid(lay.below(solid), file.robot.surface.size_m(), file.mesher);
    plan.first_pour_m3 = main.volume_m3();
    plan.air_holes = core_holes(lay, main, file.settings);
    add_pieces(lay, filled, solid, plan);
    plan.block_volume_m3 -= cavities_m3(file.robot.surface);
    return plan;
  }
  throw NoMould("no plane along the robot's axes parts a lid off so that the rest leaves its mould and its core");
}

}  // namespace soft_robot_lab
