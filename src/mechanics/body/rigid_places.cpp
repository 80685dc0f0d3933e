// SPDX-License-Identifier: BSD-3-Clause
#include "rigid_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "free_obstacles.h"
#include "gap.h"
#include "mesh_solid.h"
#include "rigid_features.h"

namespace soft_robot_lab {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr int kOnRim = 24;
constexpr int kOnLine = 24, kOnShortLine = 4;  // parts of a line, of a short one at least
constexpr double kApart = 2.0 * M_PI / kOnRim;
constexpr int kHalvings = 50;         // of an arc in which the nearest point of a rim is
constexpr double kFlat = 1e-3;        // of its radius: a rim whose points are so alike lies flat on the other
constexpr double kParallel = 1e-6;    // sine of an angle
constexpr double kBesideFace = 0.05;  // how far a normal may point past a face of its edge
constexpr double kBesideEnd = 1e-6;   // of its length: so far past its ends an edge crosses others that end there too
constexpr int kCuts = 250;            // each leaves 0.84 of the volume in which the nearest place is
constexpr double kDeepest = 0.5;      // of the smaller of two half extents
constexpr double kInside = 0.25;      // steps: no flat face bears an edge there, which crosses its own edges
constexpr std::size_t kCrossings = 50000;  // of edges of two meshes

Features features(const Plane& /*never free, and touched alone*/) { return {}; }
Features features(const Sphere& sphere) { return {{{sphere.center_m, sphere.radius_m}}, {}, {}}; }

Features features(const Capsule& capsule) {
  return {{{capsule.start_m, capsule.radius_m}, {capsule.end_m, capsule.radius_m}},
          {},
          {{capsule.start_m, capsule.end_m, capsule.radius_m, {}}}};
}

Features features(const Cylinder& cylinder) {
  const Vector3d axis = (cylinder.end_m - cylinder.start_m).normalized(), inwards = cylinder.rounding_m * axis;
  const Vector3d start_m = cylinder.start_m + inwards, end_m = cylinder.end_m - inwards;
  const double radius_m = cylinder.radius_m - cylinder.rounding_m;
  return {{},
          {{start_m, -axis, radius_m, cylinder.rounding_m}, {end_m, axis, radius_m, cylinder.rounding_m}},
          {{start_m, end_m, cylinder.radius_m, {}, true}}};
}

Features features(const RoundedBox& box) {
  const Vector3d half_m = 0.5 * box.size_m - Vector3d::Constant(box.rounding_m);
  const auto corner = [&](const Vector3d& sign) -> Vector3d { return box.center_m + sign.cwiseProduct(half_m); };
  Features all;
  for (int bits = 0; bits < 8; ++bits) {
    const Vector3d sign(bits & 1 ? 1.0 : -1.0, bits & 2 ? 1.0 : -1.0, bits & 4 ? 1.0 : -1.0);
    all.points.push_back({corner(sign), box.rounding_m});
    for (int axis = 0; axis < 3; ++axis) {
      if (sign[axis] > 0.0) continue;
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      all.lines.push_back({corner(sign),
                           corner(sign - 2.0 * sign[axis] * Vector3d::Unit(axis)),
                           box.rounding_m,
                           {sign[u] * Vector3d::Unit(u), sign[v] * Vector3d::Unit(v)}});
    }
  }
  return all;
}

void add_points(const Eigen::Matrix3Xd& places_m, Features& all) {
  for (const auto& at_m : places_m.colwise()) all.points.push_back({at_m, 0.0});
}

// Edges of others meet it wherever they are, so its own are left out.
Features features(const MeshShape& mesh) {
  Features all;
  add_points(mesh.solid->corners_m(), all);
  return all;
}

// For another mesh.
Features all_features(const MeshShape& mesh) {
  Features all = features(mesh);
  add_points(mesh.solid->beside_corners_m(), all);
  for (const MeshEdge& edge : mesh.solid->edges())
    all.lines.push_back({edge.from_m, edge.to_m, 0.0, {edge.normals[0], edge.normals[1]}});
  return all;
}

// Of a mesh its corners alone.
Features features_on_shapes(const ObstacleShape& shape) {
  return std::visit([](const auto& one) { return features(one); }, shape);
}

}  // namespace

Gap gap_of_ball(const ObstacleShape& shape, const Isometry3d& pose, const Vector3d& point_m, double radius_m) {
  const auto* mesh = std::get_if<MeshShape>(&shape);
  if (mesh == nullptr) return gap_to(shape, pose, point_m);
  const Gap own = mesh->solid->gap_of_ball(pose.inverse() * point_m, radius_m);
  return {own.gap_m, pose.linear() * own.normal, pose.linear() * own.hessian * pose.linear().transpose()};
}

Vector3d radius_at_m(const RoundedRim& rim, const Vector3d& across, double angle_rad) {
  return rim.radius_m * (std::cos(angle_rad) * across + std::sin(angle_rad) * rim.outward.cross(across));
}

namespace {

void add_on_shape(const Features& features, bool of_other, std::vector<RigidPlace>& all) {
  for (const RoundedPoint& point : features.points) all.push_back({of_other, BallOnShape{point}});
  for (const RoundedRim& rim : features.rims) {
    const Vector3d across = rim.outward.unitOrthogonal();
    for (int i = 0; i < kOnRim; ++i)
      all.push_back({of_other, BallOnShape{{rim.middle_m + radius_at_m(rim, across, kApart * i), rim.rounding_m}}});
    for (const int valley : {0, 1}) all.push_back({of_other, RimOnShape{rim, valley}});
  }
}

// Lines of a shape of that size; 0: each of them is long. Where a line is nearest it meets the mesh only so far inside.
void add_on_mesh(const Features& features, double size_m, double inside_m, bool of_other,
                 std::vector<RigidPlace>& all) {
  for (const RoundedLine& line : features.lines) {
    const Vector3d along_m = line.to_m - line.from_m;
    const int parts = static_cast<int>(
        std::clamp(std::ceil(kOnLine * along_m.norm() / size_m), double{kOnShortLine}, double{kOnLine}));
    const double from_end_m = line.flat_ends ? line.radius_m : 0.0;  // balls nearer to it would stand out there
    for (int i = 1; i < parts; ++i)
      if (along_m.norm() * std::min(i, parts - i) / parts >= from_end_m)
        all.push_back({of_other, BallOnShape{{line.from_m + along_m * i / parts, line.radius_m}}});
    RoundedLine thin = line;
    thin.radius_m -= inside_m;
    for (const int valley : {0, 1}) all.push_back({of_other, LineOnMesh{thin, parts, valley}});
  }
}

void add_crossings(const Features& own, const Features& theirs, double deepest_m, std::vector<RigidPlace>& all) {
  for (const RoundedLine& line : own.lines)
    for (const RoundedLine& across : theirs.lines) all.push_back({false, LineOnLine{line, across, deepest_m}});
}

// In robot_base.
RoundedLine placed(const RoundedLine& line, const Isometry3d& pose) {
  RoundedLine there{pose * line.from_m, pose * line.to_m, line.radius_m, {}};
  for (const Vector3d& face : line.faces) there.faces.emplace_back(pose.linear() * face);
  return there;
}

RoundedRim placed(const RoundedRim& rim, const Isometry3d& pose) {
  return {pose * rim.middle_m, pose.linear() * rim.outward, rim.radius_m, rim.rounding_m};
}

// Whether a surface whose faces meet in an edge has this normal there.
bool faces_towards(const std::vector<Vector3d>& faces, const Vector3d& normal) {
  return std::all_of(faces.begin(), faces.end(),
                     [&](const Vector3d& face) { return face.dot(normal) >= -kBesideFace; });
}

// The one of two opposite normals that points out of the second of two edges and into the first; of two axes the one
// along which they are apart. Zero where there is none.
Vector3d outward(const Vector3d& normal, const std::vector<Vector3d>& own, const std::vector<Vector3d>& other,
                 const Vector3d& apart_m) {
  const bool back = normal.dot(apart_m) < 0.0;
  for (const double sign : {back ? -1.0 : 1.0, back ? 1.0 : -1.0}) {
    if (own.empty() && other.empty() && sign != (back ? -1.0 : 1.0)) break;
    if (faces_towards(other, sign * normal) && faces_towards(own, -sign * normal)) return sign * normal;
  }
  return Vector3d::Zero();
}

// Of the closest points of two straight lines: coordinates along them in lengths of their directions.
Eigen::Vector2d closest(const Vector3d& own_m, const Vector3d& along, const Vector3d& other_m, const Vector3d& across) {
  const Vector3d square = along.cross(across), way_m = other_m - own_m;
  return Eigen::Vector2d(way_m.cross(across).dot(square), way_m.cross(along).dot(square)) / square.squaredNorm();
}

std::optional<RigidMeeting> meet_with(const BallOnShape& place, const Isometry3d& own_pose, const ObstacleShape& shape,
                                      const Isometry3d& pose) {
  const Vector3d middle_m = own_pose * place.ball.position_m;
  const Gap gap = gap_of_ball(shape, pose, middle_m, place.ball.radius_m);
  return RigidMeeting{gap.gap_m - place.ball.radius_m, gap.normal, middle_m - place.ball.radius_m * gap.normal,
                      gap.hessian};
}

// Of the places first <= i < end that are nearer than those beside them the nearest, or the second; -1: there is none.
template <class GapAt>
int nearest_valley(int first, int end, const GapAt& gap_m, int which) {
  std::array<int, 2> found{-1, -1};
  for (int i = first; i < end; ++i) {
    if (gap_m(i) > gap_m(i - 1) || gap_m(i) >= gap_m(i + 1)) continue;
    if (found[0] < 0 || gap_m(i) < gap_m(found[0]))
      found = {i, found[0]};
    else if (found[1] < 0 || gap_m(i) < gap_m(found[1]))
      found[1] = i;
  }
  return found[static_cast<std::size_t>(which)];
}

std::optional<RigidMeeting> meet_with(const RimOnShape& place, const Isometry3d& own_pose, const ObstacleShape& shape,
                                      const Isometry3d& pose) {
  const RoundedRim rim = placed(place.rim, own_pose);
  const Vector3d across = own_pose.linear() * place.rim.outward.unitOrthogonal();
  std::array<double, kOnRim> gaps_m;
  for (int i = 0; i < kOnRim; ++i) {
    const Vector3d at_m = rim.middle_m + radius_at_m(rim, across, kApart * i);
    gaps_m[static_cast<std::size_t>(i)] = gap_of_ball(shape, pose, at_m, rim.rounding_m).gap_m;
  }
  const auto [least, most] = std::minmax_element(gaps_m.begin(), gaps_m.end());
  const auto around = [&](int i) { return gaps_m[static_cast<std::size_t>((i + kOnRim) % kOnRim)]; };
  const int valley = nearest_valley(0, kOnRim, around, place.valley);
  if (valley < 0 || *most - *least < kFlat * rim.radius_m) return std::nullopt;
  Gap gap;
  Vector3d at_m, along_m;
  double curvature_m = 0.0, low_rad = kApart * (valley - 1), high_rad = kApart * (valley + 1);
  for (int i = 0; i < kHalvings; ++i) {
    const double angle_rad = 0.5 * (low_rad + high_rad);
    const Vector3d out_m = radius_at_m(rim, across, angle_rad);
    at_m = rim.middle_m + out_m;
    along_m = rim.outward.cross(out_m);
    gap = gap_of_ball(shape, pose, at_m, rim.rounding_m);
    curvature_m = along_m.dot(gap.hessian * along_m) - gap.normal.dot(out_m);
    (gap.normal.dot(along_m) > 0.0 ? high_rad : low_rad) = angle_rad;
  }
  Eigen::Matrix3d bend = gap.hessian;
  if (curvature_m > 0.0) {
    const Vector3d turn = gap.hessian * along_m;
    bend -= turn * turn.transpose() / curvature_m;
  }
  return RigidMeeting{gap.gap_m - rim.rounding_m, gap.normal, at_m - rim.rounding_m * gap.normal, bend};
}

std::optional<RigidMeeting> meet_with(const LineOnMesh& place, const Isometry3d& own_pose, const ObstacleShape& shape,
                                      const Isometry3d& pose) {
  const RoundedLine line = placed(place.line, own_pose);
  const Vector3d along_m = line.to_m - line.from_m;
  const auto gap_at = [&](double share) -> Gap {
    return gap_of_ball(shape, pose, line.from_m + share * along_m, line.radius_m);
  };
  const Gap of_middle = gap_at(0.5);
  const double least_m = of_middle.gap_m - 0.5 * along_m.norm() - line.radius_m;  // of all its points
  if (least_m > size_m(shape))
    return RigidMeeting{least_m, of_middle.normal, line.from_m + 0.5 * along_m, Eigen::Matrix3d::Zero()};
  std::array<double, kOnLine + 1> gaps_m;
  const int parts = place.parts;
  for (int i = 0; i <= parts; ++i) gaps_m[static_cast<std::size_t>(i)] = gap_at(static_cast<double>(i) / parts).gap_m;
  const auto [least, most] = std::minmax_element(gaps_m.begin(), gaps_m.begin() + parts + 1);
  const auto along = [&](int i) { return gaps_m[static_cast<std::size_t>(i)]; };
  const int valley = nearest_valley(1, parts, along, place.valley);  // its ends are corners
  if (valley < 0 || *most - *least < kFlat * along_m.norm()) return std::nullopt;
  Gap gap;
  double share = 0.0, low = static_cast<double>(valley - 1) / parts, high = static_cast<double>(valley + 1) / parts;
  for (int i = 0; i < kHalvings; ++i) {
    share = 0.5 * (low + high);
    gap = gap_at(share);
    (gap.normal.dot(along_m) > 0.0 ? high : low) = share;
  }
  const Vector3d at_m = line.from_m + share * along_m;
  const double curvature_m = along_m.dot(gap.hessian * along_m);
  Eigen::Matrix3d bend = gap.hessian;
  if (curvature_m > 0.0) {
    const Vector3d turn = gap.hessian * along_m;
    bend -= turn * turn.transpose() / curvature_m;
  }
  return RigidMeeting{gap.gap_m - line.radius_m, gap.normal, at_m - line.radius_m * gap.normal, bend};
}

std::optional<RigidMeeting> meet_with(const LineOnLine& place, const Isometry3d& own_pose,
                                      const ObstacleShape& /*shape*/, const Isometry3d& pose) {
  const Vector3d from_m = own_pose * place.own.from_m, other_from_m = pose * place.other.from_m,
                 along = own_pose * place.own.to_m - from_m, across = pose * place.other.to_m - other_from_m,
                 square = along.cross(across);
  if (square.norm() < kParallel * along.norm() * across.norm()) return std::nullopt;
  const Eigen::Vector2d at = closest(from_m, along, other_from_m, across);
  if (at.minCoeff() < -kBesideEnd || at.maxCoeff() > 1.0 + kBesideEnd) return std::nullopt;
  const RoundedLine own = placed(place.own, own_pose), other = placed(place.other, pose);
  const Vector3d own_m = from_m + at[0] * along, other_m = other_from_m + at[1] * across;
  const Vector3d normal = outward(square.normalized(), own.faces, other.faces, own_m - other_m);
  const double apart_m = normal.dot(own_m - other_m);
  if (normal.isZero(0.0) || apart_m < -place.deepest_m) return std::nullopt;
  // Halfway between the surfaces' closest points, as neither is the other's.
  const Vector3d middle_m = 0.5 * (own_m - own.radius_m * normal + other_m + other.radius_m * normal);
  return RigidMeeting{apart_m - own.radius_m - other.radius_m, normal, middle_m, Eigen::Matrix3d::Zero()};
}

double bound(const Plane& /*endless*/) { return std::numeric_limits<double>::infinity(); }
double bound(const Sphere& sphere) { return sphere.radius_m; }
double bound(const Capsule& capsule) { return 0.5 * (capsule.end_m - capsule.start_m).norm() + capsule.radius_m; }
double bound(const Cylinder& cylinder) {
  return std::hypot(0.5 * (cylinder.end_m - cylinder.start_m).norm(), cylinder.radius_m);
}
double bound(const RoundedBox& box) { return 0.5 * box.size_m.norm(); }
double bound(const MeshShape& mesh) { return mesh.solid->bounding_radius_m(); }

bool is_mesh(const ObstacleShape& shape) { return std::holds_alternative<MeshShape>(shape); }
bool has_edges(const ObstacleShape& shape) { return is_mesh(shape) || std::holds_alternative<RoundedBox>(shape); }

// Behind an edge there is no less of the shape, but for sharp ones.
double behind_edges_m(const ObstacleShape& shape) {
  const auto* mesh = std::get_if<MeshShape>(&shape);
  return mesh == nullptr ? kDeepest * size_m(shape) : mesh->solid->half_thickness_m();
}

// Of two meshes, or a mesh and a box. Where their edges are few these cross as they are, and only what is deep meets
// the other where it is nearest; otherwise all does.
std::vector<RigidPlace> places_with_meshes(const ObstacleShape& one, const ObstacleShape& other) {
  const Features own = features_of(one), theirs = features_of(other);
  const bool few = own.lines.size() * theirs.lines.size() <= kCrossings;
  std::vector<RigidPlace> all;
  for (const bool of_other : {false, true}) {
    const ObstacleShape &its = of_other ? other : one, &on = of_other ? one : other;
    const Features& features = of_other ? theirs : own;
    add_on_shape(features, of_other, all);
    const auto* mesh = std::get_if<MeshShape>(&on);
    if (mesh == nullptr) continue;
    const bool cross = few && mesh->solid->edges_are_all();
    const double inside_m = cross ? kInside * mesh->solid->rounding_m() : 0.0;
    add_on_mesh(features, 2.0 * bounding_radius_m(its), inside_m, of_other, all);
  }
  if (few) add_crossings(own, theirs, std::min(behind_edges_m(one), behind_edges_m(other)), all);
  return all;
}

}  // namespace

Features features_of(const ObstacleShape& shape) {
  return is_mesh(shape) ? all_features(std::get<MeshShape>(shape)) : features_on_shapes(shape);
}

std::vector<RigidPlace> rigid_places(const ObstacleShape& one, const ObstacleShape& other) {
  if ((is_mesh(one) && has_edges(other)) || (is_mesh(other) && has_edges(one))) return places_with_meshes(one, other);
  const Features own = features_on_shapes(one), theirs = features_on_shapes(other);
  std::vector<RigidPlace> all;
  if (std::holds_alternative<Sphere>(other) && !std::holds_alternative<Sphere>(one)) {
    add_on_shape(theirs, true, all);
    return all;
  }
  add_on_shape(own, false, all);
  if (std::holds_alternative<Sphere>(one)) return all;
  add_on_shape(theirs, true, all);
  if (is_mesh(one) || is_mesh(other)) {
    add_on_mesh(is_mesh(other) ? own : theirs, 0.0, 0.0, is_mesh(one), all);
    return all;
  }
  add_crossings(own, theirs, kDeepest * std::min(size_m(one), size_m(other)), all);
  return all;
}

namespace {

// Edges are through one another only where each is in the other's solid: beyond a thin wall, or where a mesh is hollow,
// lines have crossed without that.
bool is_crossing(const RigidMeeting& met, const ObstacleShape& one, const Isometry3d& one_pose,
                 const ObstacleShape& other, const Isometry3d& other_pose) {
  if (met.gap_m >= 0.0) return true;
  const auto within = [](const ObstacleShape& shape, const Isometry3d& pose, const Vector3d& at_m) {
    const auto* mesh = std::get_if<MeshShape>(&shape);
    return mesh == nullptr || gap_to(shape, pose, at_m).gap_m < mesh->solid->rounding_m();
  };
  const Vector3d half_m = 0.5 * met.gap_m * met.normal;
  return within(other, other_pose, met.position_m + half_m) && within(one, one_pose, met.position_m - half_m);
}

}  // namespace

std::optional<RigidMeeting> meet(const RigidPlace& place, const ObstacleShape& one, const Isometry3d& one_pose,
                                 const ObstacleShape& other, const Isometry3d& other_pose) {
  const auto with = [&](const auto& kind) {
    return place.of_other ? meet_with(kind, other_pose, one, one_pose) : meet_with(kind, one_pose, other, other_pose);
  };
  std::optional<RigidMeeting> met = std::visit(with, place.kind);
  if (met && place.of_other) met->normal = -met->normal;
  if (met && std::holds_alternative<LineOnLine>(place.kind) && !is_crossing(*met, one, one_pose, other, other_pose))
    return std::nullopt;
  return met;
}

double bounding_radius_m(const ObstacleShape& shape) {
  return std::visit([](const auto& one) { return bound(one); }, shape);
}

double spheres_apart_m(const PlacedShape& one, const PlacedShape& other) {
  const Vector3d middle_m = one.pose * center_m(one.shape);
  const double way_m = std::holds_alternative<Plane>(other.shape)
                           ? gap_to(other.shape, other.pose, middle_m).gap_m
                           : (other.pose * center_m(other.shape) - middle_m).norm() - bounding_radius_m(other.shape);
  return way_m - bounding_radius_m(one.shape);
}

// Of all their places: a mesh need not be convex.
double least_gap_m(const PlacedShape& one, const PlacedShape& other) {
  double least_m = std::numeric_limits<double>::infinity();
  for (const RigidPlace& place : rigid_places(one.shape, other.shape)) {
    const std::optional<RigidMeeting> met = meet(place, one.shape, one.pose, other.shape, other.pose);
    if (met) least_m = std::min(least_m, met->gap_m);
  }
  return least_m;
}

// The larger of the distances from a point to both is convex, and half of what they are apart where it is least: found
// by ellipsoids around that place, each cut through its middle (Shor 1977).
double apart_by_cuts_m(const PlacedShape& one, const PlacedShape& other, int cuts) {
  Vector3d at_m = one.pose * center_m(one.shape);
  const double reach_m = bounding_radius_m(one.shape) + std::max(0.0, gap_to(other.shape, other.pose, at_m).gap_m);
  Eigen::Matrix3d around_m2 = reach_m * reach_m * Eigen::Matrix3d::Identity();
  double least_m = std::numeric_limits<double>::infinity();
  for (int cut = 0; cut < cuts; ++cut) {
    const Gap own = gap_to(one.shape, one.pose, at_m), others = gap_to(other.shape, other.pose, at_m);
    const Gap& larger = own.gap_m > others.gap_m ? own : others;
    least_m = std::min(least_m, larger.gap_m);
    const Vector3d along_m2 = around_m2 * larger.normal;
    const double square_m2 = larger.normal.dot(along_m2);
    if (square_m2 <= 0.0) break;
    at_m -= along_m2 / (4.0 * std::sqrt(square_m2));
    around_m2 = 9.0 / 8.0 * (around_m2 - 0.5 / square_m2 * along_m2 * along_m2.transpose());
  }
  return 2.0 * least_m;
}

double apart_m(const PlacedShape& one, const PlacedShape& other) {
  if (is_mesh(one.shape) || is_mesh(other.shape)) return least_gap_m(one, other);
  return apart_by_cuts_m(one, other, kCuts);
}

}  // namespace soft_robot_lab
