// SPDX-License-Identifier: BSD-3-Clause
#include "make_mould.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <Eigen/Geometry>

#include "build_solids.h"
#include "inside_solid.h"
#include "robot/design/surface_file.h"
#include "thickness.h"

namespace soft_robot_lab {
namespace {

constexpr int kCircleSegments = 96;       // a round wall of 45 mm radius is off by 0.02 mm
constexpr double kEdgesAcrossMould = 30;  // of the robot's box
constexpr double kSliver_m2 = 1e-10;      // a facet so small has no normal to speak of
constexpr double kSmallestEdge_m = 4e-4;  // a bore of 0.5 mm radius is off by 0.04 mm

Surface mesh_piece(const Solid& solid, double largest_edge_m, const MesherOptions& options) {
  SurfaceRequest request;
  request.solid = solid;
  request.largest_edge_m = largest_edge_m;
  request.circle_segments = kCircleSegments;
  request.smallest_edge_m = std::min(kSmallestEdge_m, largest_edge_m);
  return read_off(surface_file_for(request, options));
}

double in_stl(double value_m) { return static_cast<double>(static_cast<float>(1000 * value_m)) / 1000; }

MouldPart stand_on_bed(const MouldPiece& piece, const Surface& surface) {
  MouldPart part;
  part.name = piece.name;
  part.rotation = piece.to_print;
  const Eigen::Matrix3Xd turned = piece.to_print * surface.vertices_m;
  part.offset_m = -turned.rowwise().minCoeff();
  const Eigen::Matrix3Xd moved = (turned.colwise() + part.offset_m).unaryExpr(&in_stl);
  part.surface = make_surface(moved, surface.triangles);
  return part;
}

// The same with round sides as they are.
std::string step_of(const MouldPiece& piece, const MouldPart& part, const MesherOptions& options) {
  const Eigen::AngleAxisd turn(piece.to_print);
  Solid turned = combined(Solid::Kind::rotate, {piece.solid});
  turned.axis = turn.axis();
  turned.angle_deg = turn.angle() * 180 / M_PI;
  Solid moved = combined(Solid::Kind::translate, {turn.angle() == 0 ? piece.solid : turned});
  moved.by_m = part.offset_m;
  return step_file_for(moved, options);
}

double distance_m(const RayTree& tree, const Eigen::Vector3d& point_m) {
  double least = INFINITY;
  tree.near(point_m, 2 * kLargestDistance_m, [&](int triangle) {
    least = std::min(least, (nearest_point(tree.surface(), triangle, point_m) - point_m).norm());
  });
  return least;
}

// Skin that the mould does not touch, or the mould's skin that forms no silicone.
struct Apart {
  const MouldPlan& plan;
  double air_hole_m;

  bool on_plane(const Surface& surface, int t, int axis, double height_m) const {
    const Eigen::Vector3d way = plan.frame.col(axis);
    return std::abs(way.dot(surface.centre(t)) - height_m) < 1e-6 && std::abs(way.dot(surface.normals.col(t))) > 0.999;
  }
  bool at_rim(const Surface& surface, int t) const { return on_plane(surface, t, 2, plan.rim_m); }
  bool near_air_hole(const Eigen::Vector3d& at_m) const {
    return std::any_of(plan.air_holes.begin(), plan.air_holes.end(), [&](const AirHole& hole) {
      return (at_m - hole.from_m).cross(plan.direction).norm() < 1.01 * air_hole_m;
    });
  }
  bool outside(const MouldPiece& piece, const Surface& surface, int t) const {
    const Eigen::Vector3d at = plan.frame.transpose() * surface.centre(t);
    const double tolerance = 1e-6;
    if ((at.array() < piece.form_low_m.array() - tolerance).any() ||
        (at.array() > piece.form_high_m.array() + tolerance).any())
      return true;
    if (plan.two_part && on_plane(surface, t, 1, plan.parting_m)) return true;
    return at_rim(surface, t) || near_air_hole(surface.centre(t));
  }
};

// How far a facet of the cavity is off the solid whose equations are asked, at its centre: silicone just before it,
// none just behind.
double off_solid_m(const Solid& cast, const Eigen::Vector3d& centre, const Eigen::Vector3d& normal) {
  for (double step = kLargestDistance_m / 64; step < 1.5 * kLargestDistance_m; step *= 2)
    if (contains(cast, centre + step * normal) && !contains(cast, centre - step * normal)) return step;
  return INFINITY;
}

// Of all facets that form silicone; 0 where the solid comes from a file.
double equation_distance_m(const MouldPlan& plan, const std::vector<Surface>& pieces, double air_hole_m) {
  if (!has_equations(plan.cast)) return 0;
  const Apart apart{plan, air_hole_m};
  double worst = 0;
  for (size_t i = 0; i < pieces.size(); ++i)
    for (int t = 0; t < pieces[i].triangle_count(); ++t)
      if (pieces[i].areas_m2[t] > kSliver_m2 && !apart.outside(plan.pieces[i], pieces[i], t))
        worst = std::max(worst, off_solid_m(plan.cast, pieces[i].centre(t), pieces[i].normals.col(t)));
  return worst;
}

// Both ways: each triangle's centre of one surface to the other.
double cavity_distance_m(const MouldPlan& plan, const std::vector<Surface>& pieces, const Surface& robot,
                         double air_hole_m) {
  const Apart apart{plan, air_hole_m};
  const RayTree robot_tree(robot);
  std::vector<RayTree> trees(pieces.begin(), pieces.end());
  double worst = 0;
  for (int t = 0; t < robot.triangle_count(); ++t) {
    if (apart.at_rim(robot, t) || apart.near_air_hole(robot.centre(t))) continue;
    double least = INFINITY;
    for (const RayTree& tree : trees) least = std::min(least, distance_m(tree, robot.centre(t)));
    worst = std::max(worst, least);
  }
  for (size_t i = 0; i < pieces.size(); ++i)
    for (int t = 0; t < pieces[i].triangle_count(); ++t)
      if (!apart.outside(plan.pieces[i], pieces[i], t))
        worst = std::max(worst, distance_m(robot_tree, pieces[i].centre(t)));
  return worst;
}

template <typename... Parts>
void fault(Mould& mould, const Parts&... parts) {
  std::ostringstream text;
  text.precision(4);
  (text << ... << parts);
  mould.faults.push_back(text.str());
}

void verify_part(const MouldSettings& settings, MouldPart& part, Mould& mould) {
  const Eigen::Vector3d size = part.size_m();
  part.fits_printer = fits_printer(size, settings.printer_m);
  if (!part.fits_printer)
    fault(mould, part.name, " of ", 1000 * size.x(), " x ", 1000 * size.y(), " x ", 1000 * size.z(),
          " mm does not fit the printer (casting.printer_m).");
  const ThinPlace thinnest = measure_balls(RayTree(part.surface), settings.min_wall_m);
  part.thinnest_m = thinnest.worst_m;
  if (part.thinnest_m < settings.min_wall_m * (1 - 1e-3))
    fault(mould, part.name, " is ", 1000 * part.thinnest_m, " mm thick between ", place_text(thinnest.at_m), " and ",
          place_text(thinnest.opposite_m), " of its own axes, less than casting.min_wall_m.");
}

void verify_volumes(Mould& mould) {
  double parts = 0;
  for (size_t i = 0; i < mould.parts.size(); ++i)
    if (mould.plan.pieces[i].in_block) parts += mould.parts[i].surface.volume_m3();
  mould.closure = std::abs(mould.plan.block_volume_m3 - parts - mould.robot_volume_m3) / mould.robot_volume_m3;
  if (!(mould.closure <= kLargestClosure))
    fault(mould, "Block less mould differs from the robot's volume by ", 100 * mould.closure, " %.");
  if (!(std::max(mould.cavity_distance_m, mould.equation_distance_m) <= kLargestDistance_m))
    fault(mould, "The cavity is more than 0.1 mm off the robot's skin.");
}

Silicone to_mix(const Mould& mould, const CastRobotFile& file) {
  Silicone silicone;
  silicone.volume_m3 = mould.robot_volume_m3 * (1 + file.settings.mould.spare_fraction);
  silicone.mass_g = 1000 * silicone.volume_m3 * file.robot.density_kg_m3;
  silicone.part_a_g = silicone.mass_g * file.settings.mould.part_a_fraction;
  silicone.part_b_g = silicone.mass_g - silicone.part_a_g;
  return silicone;
}

}  // namespace

Mould make_mould(const CastRobotFile& file) {
  const MouldSettings& settings = file.settings.mould;
  Mould mould;
  mould.plan = plan_mould(file, check_casting(file));
  mould.plan.inserts = static_cast<int>(file.settings.inserts.size());
  const double edge_m = file.robot.surface.size_m() / kEdgesAcrossMould;
  const Surface robot = mesh_piece(mould.plan.cast, edge_m, file.mesher);
  mould.robot_volume_m3 = robot.volume_m3();
  std::vector<Surface> pieces;
  for (const MouldPiece& piece : mould.plan.pieces) {
    pieces.push_back(mesh_piece(piece.solid, edge_m, file.mesher));
    mould.parts.push_back(stand_on_bed(piece, pieces.back()));
    mould.parts.back().step_file = step_of(piece, mould.parts.back(), file.mesher);
    verify_part(settings, mould.parts.back(), mould);
  }
  mould.robot = make_surface(mould.plan.frame.transpose() * robot.vertices_m, robot.triangles);
  mould.cavity_distance_m = cavity_distance_m(mould.plan, pieces, robot, settings.air_hole_radius_m);
  mould.equation_distance_m = equation_distance_m(mould.plan, pieces, settings.air_hole_radius_m);
  verify_volumes(mould);
  mould.silicone = to_mix(mould, file);
  return mould;
}

}  // namespace soft_robot_lab
