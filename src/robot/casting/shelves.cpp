// SPDX-License-Identifier: BSD-3-Clause
#include "shelves.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Geometry>

#include "build_solids.h"

namespace soft_robot_lab {
namespace {

using Eigen::Vector3d;

const double kSeatEdge = std::cos(30 * M_PI / 180);
constexpr double kReach = 1.5;  // radii that a sweep goes on through skin that does not stand at right angles to it

// Points between which a path bends.
std::vector<Vector3d> bends_of(const std::vector<Vector3d>& points_m) {
  std::vector<Vector3d> kept;
  for (const Vector3d& p : points_m) {
    if (!kept.empty() && (p - kept.back()).norm() < 1e-9) continue;
    if (kept.size() > 1) {
      const Vector3d in = (kept.back() - kept[kept.size() - 2]).normalized(), out = (p - kept.back()).normalized();
      if (in.dot(out) > 1 - 1e-12) kept.pop_back();
    }
    kept.push_back(p);
  }
  return kept;
}

// Lengths along a path at which it may pass the robot's skin, with both ends.
std::vector<double> crossings_m(const RayTree& robot, const std::vector<Vector3d>& points_m) {
  std::vector<double> all{0};
  double done = 0;
  for (size_t i = 0; i + 1 < points_m.size(); ++i) {
    const Vector3d way = points_m[i + 1] - points_m[i], along = way.normalized();
    double near = 0;
    while (const auto hit = robot.first_hit(points_m[i], along, near)) {
      if (hit->distance_m >= way.norm()) break;
      all.push_back(done + hit->distance_m);
      near = hit->distance_m + robot.skip_m();
    }
    done += way.norm();
  }
  all.push_back(done);
  return all;
}

struct Run {
  double from_m, to_m, outside_m;
};

// Those inside the robot; where the robot leaves a short gap, two are one.
std::vector<Run> stretches(const RayTree& robot, const std::vector<Vector3d>& points_m, double longest_slot_m) {
  std::vector<Run> found;
  const std::vector<double> at = crossings_m(robot, points_m);
  for (size_t i = 0; i + 1 < at.size(); ++i) {
    if (at[i + 1] - at[i] < 1e-6 || !is_inside(robot, point_along(points_m, (at[i] + at[i + 1]) / 2))) continue;
    const double gap = found.empty() ? INFINITY : at[i] - found.back().to_m;
    if (gap > longest_slot_m) {
      found.push_back({at[i], at[i + 1], 0});
    } else {
      found.back().to_m = at[i + 1];
      found.back().outside_m += gap < 1e-6 ? 0 : gap;
    }
  }
  return found;
}

std::vector<Vector3d> cut_out(const std::vector<Vector3d>& points_m, const Run& stretch) {
  std::vector<Vector3d> cut{point_along(points_m, stretch.from_m)};
  double at = 0;
  for (size_t i = 0; i + 1 < points_m.size(); ++i) {
    if (at > stretch.from_m && at < stretch.to_m) cut.push_back(points_m[i]);
    at += (points_m[i + 1] - points_m[i]).norm();
  }
  cut.push_back(point_along(points_m, stretch.to_m));
  return bends_of(cut);
}

// Moves a free end on, but not to the next skin.
void reach_through(const RayTree& robot, const Vector3d& from_m, double radius_m, Vector3d& end_m) {
  const Vector3d out = (end_m - from_m).normalized();
  const auto hit = robot.first_hit(end_m, out, robot.skip_m());
  const double room = std::min(hit ? hit->distance_m / 2 : INFINITY, kReach * radius_m);
  if (!is_inside(robot, end_m + room / 2 * out)) end_m += room * out;
}

std::vector<Vector3d> swept(const RayTree& robot, std::vector<Vector3d> points_m, double radius_m) {
  const size_t last = points_m.size() - 1;
  const Vector3d second = points_m[1], before_last = points_m[last - 1];
  reach_through(robot, second, radius_m, points_m[0]);
  reach_through(robot, before_last, radius_m, points_m[last]);
  return points_m;
}

// --- footprints ---

Vector3d flattened(const Vector3d& p, const Vector3d& direction) { return p - p.dot(direction) * direction; }

// Of two segments in one plane, by their ends, which decide unless they cross.
double distance_m(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d, const Vector3d& normal) {
  const auto side = [&](const Vector3d& p, const Vector3d& q, const Vector3d& r) {
    return normal.dot((q - p).cross(r - p));
  };
  if (side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0) return 0;
  const auto to_segment = [](const Vector3d& p, const Vector3d& from, const Vector3d& to) {
    const double length2 = (to - from).squaredNorm();
    const double t = length2 > 0 ? std::clamp((p - from).dot(to - from) / length2, 0.0, 1.0) : 0;
    return (from + t * (to - from) - p).norm();
  };
  return std::min({to_segment(a, c, d), to_segment(b, c, d), to_segment(c, a, b), to_segment(d, a, b)});
}

void compare(const SheathPath& one, const SheathPath& other, const Vector3d& direction, WorstAlong& worst) {
  for (size_t i = 0; i + 1 < one.points_m.size(); ++i) {
    for (size_t j = 0; j + 1 < other.points_m.size(); ++j) {
      const double room =
          distance_m(flattened(one.points_m[i], direction), flattened(one.points_m[i + 1], direction),
                     flattened(other.points_m[j], direction), flattened(other.points_m[j + 1], direction), direction) -
          one.radius_m - other.radius_m;
      if (room < worst.worst_m) worst = {room, one.points_m[i], one.name, other.name};
    }
  }
}

// --- solids ---

Solid ball(const Vector3d& at_m, double radius_m) {
  Solid solid;
  solid.kind = Solid::Kind::sphere;
  solid.center_m = at_m;
  solid.radius_m = radius_m;
  return solid;
}

// Local axes x, y, z become the frame's columns.
Solid placed(const Solid& inner, const Eigen::Matrix3d& frame, const Vector3d& at_m) {
  const Eigen::AngleAxisd turn(frame);
  Solid turned = combined(Solid::Kind::rotate, {inner});
  turned.axis = turn.axis();
  turned.angle_deg = turn.angle() * 180 / M_PI;
  Solid moved = combined(Solid::Kind::translate, {turned});
  moved.by_m = at_m;
  return moved;
}

// A wall along one segment, from `lift_m` above its axis to a height along the direction; of which side is free.
Solid wall(const Vector3d& from_m, const Vector3d& to_m, const Vector3d& direction, double lift_m, double height_m,
           double half_m) {
  const Vector3d along = flattened(to_m - from_m, direction);
  Eigen::Matrix3d frame;
  frame << along.normalized(), direction, along.normalized().cross(direction);
  const double rise = direction.dot(to_m - from_m), end = height_m - direction.dot(from_m);
  Solid solid;
  solid.kind = Solid::Kind::extrude;
  solid.polygon_m = {{0, lift_m}, {along.norm(), rise + lift_m}, {along.norm(), end}, {0, end}};
  solid.z_m = {-half_m, half_m};
  return placed(solid, frame, from_m);
}

// The tube itself, round at its bends.
void add_tube(const std::vector<Vector3d>& points_m, double radius_m, std::vector<Solid>& parts) {
  for (size_t i = 0; i + 1 < points_m.size(); ++i) parts.push_back(round_bar(points_m[i], points_m[i + 1], radius_m));
  for (size_t i = 1; i + 1 < points_m.size(); ++i) parts.push_back(ball(points_m[i], radius_m));
}

// What lies between the tube's axis, or a line so far above it, and a height.
void add_walls(const std::vector<Vector3d>& points_m, const Vector3d& direction, double lift_m, double height_m,
               double half_m, std::vector<Solid>& parts) {
  for (size_t i = 0; i + 1 < points_m.size(); ++i)
    parts.push_back(wall(points_m[i], points_m[i + 1], direction, lift_m, height_m, half_m));
  for (size_t i = 1; i + 1 < points_m.size(); ++i) {
    const Vector3d& p = points_m[i];
    parts.push_back(round_bar(p + lift_m * direction, p + (height_m - direction.dot(p)) * direction, half_m));
  }
}

}  // namespace

double SheathPiece::length_m() const {
  double length = 0;
  for (size_t i = 0; i + 1 < points_m.size(); ++i) length += (points_m[i + 1] - points_m[i]).norm();
  return length;
}

std::vector<SheathPiece> sheath_pieces(const RayTree& robot, const std::vector<SheathPath>& paths,
                                       double longest_slot_m) {
  std::vector<SheathPiece> pieces;
  for (const SheathPath& path : paths) {
    const std::vector<Vector3d> points = bends_of(path.points_m);
    for (const Run& stretch : stretches(robot, points, longest_slot_m)) {
      const std::vector<Vector3d> cut = cut_out(points, stretch);
      pieces.push_back({path.name, cut, swept(robot, cut, path.radius_m), path.radius_m, stretch.outside_m});
    }
  }
  return pieces;
}

WorstAlong nearest_footprints(const std::vector<SheathPath>& paths, const Vector3d& direction) {
  WorstAlong worst;
  for (size_t i = 0; i < paths.size(); ++i)
    for (size_t j = 0; j < i; ++j) compare(paths[i], paths[j], direction, worst);
  return worst;
}

WorstAlong steepest_sheath(const std::vector<SheathPath>& paths, const Vector3d& direction) {
  WorstAlong worst{90, Vector3d::Zero(), "", ""};
  for (const SheathPath& path : paths) {
    for (size_t i = 0; i + 1 < path.points_m.size(); ++i) {
      const Vector3d way = path.points_m[i + 1] - path.points_m[i];
      if (way.norm() < 1e-9) continue;
      const double angle = std::acos(std::min(1.0, std::abs(way.normalized().dot(direction)))) * 180 / M_PI;
      if (angle < worst.worst_m) worst = {angle, path.points_m[i], path.name, ""};
    }
  }
  return worst;
}

Solid less_swept_sheaths(const Solid& robot, const std::vector<SheathPiece>& pieces, const Vector3d& direction,
                         const MouldHeights& heights, double clearance_m) {
  std::vector<Solid> parts{robot};
  for (const SheathPiece& piece : pieces) {
    add_tube(piece.swept_m, piece.radius_m + clearance_m, parts);
    add_walls(piece.swept_m, direction, 0, heights.floor_m, piece.radius_m + clearance_m, parts);
  }
  return parts.size() > 1 ? combined(Solid::Kind::difference, parts) : robot;
}

Solid cast_on_shelves(const Solid& robot, const std::vector<SheathPiece>& pieces, const Vector3d& direction,
                      const MouldHeights& heights, double clearance_m) {
  if (pieces.empty()) return robot;
  std::vector<Solid> less_shelves{robot}, slots;
  for (const SheathPiece& piece : pieces) {
    const double radius = piece.radius_m + clearance_m;
    std::vector<Solid> walls, tube;
    add_walls(piece.swept_m, direction, -kSeatEdge * radius, heights.floor_m, radius, walls);
    add_tube(piece.swept_m, radius, tube);
    std::vector<Solid> shelf{combined(Solid::Kind::union_of, walls)};
    shelf.insert(shelf.end(), tube.begin(), tube.end());
    less_shelves.push_back(combined(Solid::Kind::difference, shelf));
    if (piece.in_teeth_m == 0) continue;
    add_tube(piece.points_m, radius, slots);
    add_walls(piece.points_m, direction, -kSeatEdge * radius, heights.top_m, radius, slots);
  }
  const Solid rest = combined(Solid::Kind::difference, less_shelves);
  if (slots.empty()) return rest;
  slots.insert(slots.begin(), rest);
  return combined(Solid::Kind::union_of, slots);
}

double flash_m3(const std::vector<SheathPiece>& pieces, const Vector3d& direction, const MouldHeights& heights,
                double clearance_m) {
  return std::accumulate(pieces.begin(), pieces.end(), 0.0, [&](double sum, const SheathPiece& piece) {
    const double radius = piece.radius_m + clearance_m, height = heights.top_m - direction.dot(piece.points_m[0]);
    const double above = 2 * radius * height - M_PI / 2 * radius * radius;
    return sum + piece.in_teeth_m * above;
  });
}

}  // namespace soft_robot_lab
