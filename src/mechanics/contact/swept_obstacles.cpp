// SPDX-License-Identifier: BSD-3-Clause
#include "swept_obstacles.h"

#include <algorithm>
#include <limits>
#include <variant>

#include "mechanics/body/gap.h"

namespace soft_robot_lab {
namespace {

constexpr double kMostDepth = 0.5;  // of an obstacle's half least extent, or of a face's size
constexpr double kNear = 0.05;      // of the allowed depth: nearer than that is there
constexpr int kMostAdvances = 100;
constexpr double kMostOverNodes = 5.0 / 3.0;  // a quadratic face's point moves over its nodes: sum of |N| at its middle

}  // namespace

double part_until(const ObstacleShape& shape, const Eigen::Isometry3d& pose, const Eigen::Vector3d& from_m,
                  const Eigen::Vector3d& way_m, double depth_m, double near_m) {
  double part = 0.0;
  for (int advance = 0; advance < kMostAdvances && part < 1.0; ++advance) {
    const double left_m = gap_to(shape, pose, from_m + part * way_m).gap_m + depth_m;
    if (left_m <= near_m && part > 0.0) return part;
    part += std::max(left_m, near_m) / way_m.norm();
  }
  return std::min(part, 1.0);
}

double allowed_depth_m(const Obstacle& obstacle, double face_size_m) {
  if (std::holds_alternative<Plane>(obstacle.shape)) return std::numeric_limits<double>::infinity();
  return kMostDepth * std::min(size_m(obstacle.shape), face_size_m);
}

double part_before_obstacles(const Body& body, const ContactTerm& contact, const Eigen::Matrix3Xd& positions_m,
                             const Eigen::Matrix3Xd& motion_m, const ContactState& state) {
  const ContactPoints& points = contact.points();
  double part = 1.0;
  if (points.count() == 0) return part;
  const double most_m = kMostOverNodes * motion_m.colwise().norm().maxCoeff(),
               least_face_m = points.least_face_size_m();
  for (std::size_t i = 0; i < body.obstacles().size(); ++i) {
    const Obstacle& obstacle = body.obstacles()[i];
    if (std::holds_alternative<Plane>(obstacle.shape) || obstacle.is_free()) continue;
    if (most_m <= allowed_depth_m(obstacle, least_face_m)) continue;
    const Eigen::Isometry3d pose = contact.pose_of(static_cast<int>(i), state);
    for (int point = 0; point < points.count(); ++point) {
      const double allowed_m = allowed_depth_m(obstacle, points.face_size_m(point));
      const Eigen::Vector3d way_m = points.at(point, motion_m);
      if (part * way_m.norm() <= allowed_m) continue;
      const Eigen::Vector3d from_m = points.at(point, positions_m);
      const double gap_m = gap_to(obstacle.shape, pose, from_m).gap_m;
      const double depth_m = std::max(allowed_m, -gap_m + kNear * allowed_m);
      if (part * way_m.norm() > gap_m + depth_m)
        part = std::min(part, part_until(obstacle.shape, pose, from_m, way_m, depth_m, kNear * allowed_m));
    }
  }
  return part;
}

double part_before_contact(const Body& body, const ContactTerm& contact, const Eigen::Matrix3Xd& positions_m,
                           const Eigen::Matrix3Xd& motion_m, const ContactState& state) {
  return std::min(contact.skin().first_length(positions_m, motion_m),
                  part_before_obstacles(body, contact, positions_m, motion_m, state));
}

}  // namespace soft_robot_lab
