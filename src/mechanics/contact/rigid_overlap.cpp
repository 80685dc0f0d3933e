// SPDX-License-Identifier: BSD-3-Clause
#include "rigid_overlap.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "mechanics/body/free_obstacles.h"
#include "mechanics/body/gap.h"
#include "mechanics/body/rigid_depth.h"

namespace soft_robot_lab {
namespace {

constexpr double kHalfway = 0.5;        // of half the lesser of two least extents: so deep may things be on the way
constexpr double kShareBetween = 1e-3;  // of a way, between places that are looked at

// From where a step began, to where an obstacle is now.
struct RigidWay {
  Eigen::Isometry3d from;
  Eigen::Vector3d middle_m, move_m, turn_rad;

  Eigen::Isometry3d after(double share) const { return moved_about(middle_m, share * move_m, share * turn_rad) * from; }
};

RigidWay way_to(const Obstacle& obstacle, int index, const ContactTerm& contact, const ContactState& state) {
  const int free = contact.free().index_of(index);
  RigidWay way;
  way.from = free >= 0 ? contact.free().pose(free, state.free_before) : pose_at(obstacle, state.before_s);
  way.middle_m = way.from * center_m(obstacle.shape);
  const Eigen::Isometry3d change = contact.pose_of(index, state) * way.from.inverse();
  way.move_m = change * way.middle_m - way.middle_m;
  way.turn_rad = turn_rad(change);
  return way;
}

// `look(one, other)` at each two obstacles of which one is free; the first is.
template <class Look>
void for_each_pair(const std::vector<Obstacle>& obstacles, const Look& look) {
  for (std::size_t one = 0; one < obstacles.size(); ++one)
    for (std::size_t other = 0; obstacles[one].is_free() && other < obstacles.size(); ++other)
      if (other != one && (other > one || !obstacles[other].is_free())) look(one, other);
}

void keep_deeper(double depth_m, double allowed_m, std::size_t one, std::size_t other, RigidOverlap& deepest) {
  if (depth_m * deepest.allowed_m < deepest.depth_m * allowed_m || depth_m == 0.0) return;
  deepest = {depth_m, allowed_m, static_cast<int>(one), static_cast<int>(other)};
}

// In one another where their ways end, or half through one on the way. What turns endlessly far, as a plane, is looked
// at where it ends.
double depth_on_way_m(const Obstacle& own, const RigidWay& way, const Obstacle& others, const RigidWay& other_way,
                      double way_m, double allowed_m) {
  const auto depth_after_m = [&](double share, double least_m) -> double {
    return depth_beyond_m({own.shape, way.after(share)}, {others.shape, other_way.after(share)}, least_m);
  };
  double deepest_m = depth_after_m(1.0, allowed_m);
  const double halfway_m = std::max(allowed_m, kHalfway * std::min(size_m(own.shape), size_m(others.shape)));
  const double stride = std::max(halfway_m / way_m, kShareBetween);
  for (double share = stride; share < 1.0 && std::isfinite(way_m); share += stride)
    deepest_m = std::max(deepest_m, depth_after_m(share, halfway_m));
  return deepest_m > 0.0 && depth_after_m(0.0, allowed_m) > 0.0 ? 0.0 : deepest_m;
}

}  // namespace

RigidOverlap overlap_at(const Body& body, const ContactTerm& contact, const ContactState& state) {
  RigidOverlap deepest;
  if (contact.free().count() == 0) return deepest;
  const std::vector<Obstacle>& obstacles = body.obstacles();
  for_each_pair(obstacles, [&](std::size_t one, std::size_t other) {
    const ObstacleShape &own = obstacles[one].shape, &others = obstacles[other].shape;
    const double allowed_m = allowed_overlap_m(own, others);
    const double depth_m = depth_beyond_m({own, contact.pose_of(static_cast<int>(one), state)},
                                          {others, contact.pose_of(static_cast<int>(other), state)}, allowed_m);
    keep_deeper(depth_m, allowed_m, one, other, deepest);
  });
  return deepest;
}

RigidOverlap overlap_on_way(const Body& body, const ContactTerm& contact, const ContactState& state) {
  RigidOverlap deepest;
  if (contact.free().count() == 0) return deepest;
  const std::vector<Obstacle>& obstacles = body.obstacles();
  std::vector<RigidWay> ways;
  for (std::size_t i = 0; i < obstacles.size(); ++i)
    ways.push_back(way_to(obstacles[i], static_cast<int>(i), contact, state));
  const auto turn_m = [&](std::size_t index) {
    const double turn_rad = ways[index].turn_rad.norm();
    return turn_rad > 0.0 ? turn_rad * bounding_radius_m(obstacles[index].shape) : 0.0;
  };
  for_each_pair(obstacles, [&](std::size_t one, std::size_t other) {
    const ObstacleShape &own = obstacles[one].shape, &others = obstacles[other].shape;
    const double way_m = (ways[one].move_m - ways[other].move_m).norm() + turn_m(one) + turn_m(other);
    if (spheres_apart_m({own, ways[one].after(1.0)}, {others, ways[other].after(1.0)}) > way_m) return;
    const double allowed_m = allowed_overlap_m(own, others);
    keep_deeper(depth_on_way_m(obstacles[one], ways[one], obstacles[other], ways[other], way_m, allowed_m), allowed_m,
                one, other, deepest);
  });
  return deepest;
}

std::string text_of(const RigidOverlap& overlap, const Body& body) {
  const auto name = [&](int index) { return "'" + body.obstacles()[static_cast<std::size_t>(index)].name + "'"; };
  std::ostringstream text;
  text << "obstacles " << name(overlap.one) << " and " << name(overlap.other) << " are " << overlap.depth_m
       << " m in one another, out of range [0, " << overlap.allowed_m << "]";
  return text.str();
}

}  // namespace soft_robot_lab
