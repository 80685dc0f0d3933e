// SPDX-License-Identifier: BSD-3-Clause
#include "swept_obstacles.h"

#include <algorithm>
#include <limits>
#include <variant>

#include "gap.h"

namespace soft_robot_lab {
namespace {

constexpr double kMostDepth = 0.5;  // of an obstacle's half least extent, or of a face's size
constexpr double kNear = 0.05;      // of the allowed depth: nearer than that is there
constexpr int kMostAdvances = 100;
constexpr double kMostOverNodes = 5.0 / 3.0;  // a quadratic face's point moves over its nodes: sum of |N| at its middle

// The pose of an obstacle after a part of the free obstacles' motion.
Eigen::Isometry3d pose_along(const ContactTerm& contact, int obstacle, const ContactState& state,
                             const FreeColumns& free_motion, double part) {
  const int free = contact.free().index_of(obstacle);
  if (free < 0 || free_motion.cols() == 0) return contact.pose_of(obstacle, state);
  return contact.free().pose(free, moved(state.free, part * free_motion));
}

struct Sweep {
  const ContactTerm& contact;
  const ContactState& state;
  const FreeColumns& free_motion;
  const ObstacleShape& shape;
  int obstacle;

  double gap_m(const Eigen::Vector3d& from_m, const Eigen::Vector3d& way_m, double part) const {
    return gap_to(shape, pose_along(contact, obstacle, state, free_motion, part), from_m + part * way_m).gap_m;
  }
};

// How far a free obstacle's motion carries any of its points at most.
double reach_m(const ContactTerm& contact, int obstacle, const FreeColumns& free_motion) {
  const int free = contact.free().index_of(obstacle);
  if (free < 0 || free_motion.cols() == 0) return 0.0;
  return free_motion.col(2 * free).norm() + free_motion.col(2 * free + 1).norm() * contact.free().size_m(free);
}

// Where the point first is deeper than `depth_m`.
double part_until(const Sweep& sweep, const Eigen::Vector3d& from_m, const Eigen::Vector3d& way_m, double speed_m,
                  double depth_m, double near_m) {
  double part = 0.0;
  for (int advance = 0; advance < kMostAdvances && part < 1.0; ++advance) {
    const double left_m = sweep.gap_m(from_m, way_m, part) + depth_m;
    if (left_m <= near_m && part > 0.0) return part;
    part += std::max(left_m, near_m) / speed_m;
  }
  return std::min(part, 1.0);
}

}  // namespace

double allowed_depth_m(const Obstacle& obstacle, double face_size_m) {
  if (std::holds_alternative<Plane>(obstacle.shape)) return std::numeric_limits<double>::infinity();
  return kMostDepth * std::min(size_m(obstacle.shape), face_size_m);
}

double part_before_obstacles(const Body& body, const ContactTerm& contact, const Eigen::Matrix3Xd& positions_m,
                             const Eigen::Matrix3Xd& motion_m, const ContactState& state,
                             const FreeColumns& free_motion) {
  const ContactPoints& points = contact.points();
  double part = 1.0;
  if (points.count() == 0) return part;
  const double most_m = kMostOverNodes * motion_m.colwise().norm().maxCoeff(),
               least_face_m = points.least_face_size_m();
  for (std::size_t i = 0; i < body.obstacles().size(); ++i) {
    const Obstacle& obstacle = body.obstacles()[i];
    if (std::holds_alternative<Plane>(obstacle.shape)) continue;
    const int index = static_cast<int>(i);
    const Sweep sweep{contact, state, free_motion, obstacle.shape, index};
    const double others_m = reach_m(contact, index, free_motion);
    if (most_m + others_m <= allowed_depth_m(obstacle, least_face_m)) continue;
    for (int point = 0; point < points.count(); ++point) {
      const double allowed_m = allowed_depth_m(obstacle, points.face_size_m(point));
      const Eigen::Vector3d way_m = points.at(point, motion_m);
      const double speed_m = way_m.norm() + others_m;
      if (part * speed_m <= allowed_m) continue;
      const Eigen::Vector3d from_m = points.at(point, positions_m);
      const double gap_m = sweep.gap_m(from_m, way_m, 0.0);
      const double depth_m = std::max(allowed_m, -gap_m + kNear * allowed_m);
      if (part * speed_m > gap_m + depth_m)
        part = std::min(part, part_until(sweep, from_m, way_m, speed_m, depth_m, kNear * allowed_m));
    }
  }
  return part;
}

TooDeep too_deep(const Body& body, const ContactTerm& contact, const Eigen::Matrix3Xd& positions_m,
                 const ContactState& state) {
  const ContactPoints& points = contact.points();
  TooDeep worst;
  for (std::size_t i = 0; i < body.obstacles().size(); ++i) {
    const Obstacle& obstacle = body.obstacles()[i];
    if (std::holds_alternative<Plane>(obstacle.shape)) continue;
    const Eigen::Isometry3d pose = contact.pose_of(static_cast<int>(i), state);
    for (int point = 0; point < points.count(); ++point) {
      const Eigen::Vector3d at_m = points.at(point, positions_m);
      const double beyond_m =
          -gap_to(obstacle.shape, pose, at_m).gap_m - allowed_depth_m(obstacle, points.face_size_m(point));
      if (beyond_m > worst.beyond_m) worst = {beyond_m, static_cast<int>(i), at_m};
    }
  }
  return worst;
}

}  // namespace soft_robot_lab
