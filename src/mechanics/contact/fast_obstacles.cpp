// SPDX-License-Identifier: BSD-3-Clause
#include "fast_obstacles.h"

#include <algorithm>
#include <variant>

#include "gap.h"

namespace soft_robot_lab {
namespace {

constexpr double kMostWay = 0.5;  // of the obstacle's half least extent, or of a face's size

// Where an obstacle stands after a time.
Eigen::Isometry3d pose_after(const Obstacle& obstacle, int index, const ContactTerm& contact, const ContactState& state,
                             const FreeVelocities& velocities, double h) {
  const int free = contact.free().index_of(index);
  if (free < 0) return pose_at(obstacle, state.time_s + h);
  FreeColumns way = FreeColumns::Zero(3, 2 * contact.free().count());
  way.col(2 * free) = h * velocities.linear_m_s.col(free);
  way.col(2 * free + 1) = h * velocities.angular_rad_s.col(free);
  return contact.free().pose(free, moved(state.free, way));
}

// No point of the body moves further with the obstacle.
double longest_m(const Eigen::Isometry3d& way, const Eigen::Matrix3Xd& positions_m) {
  const Eigen::Vector3d middle_m = positions_m.rowwise().mean();
  const double reach_m = (positions_m.colwise() - middle_m).colwise().norm().maxCoeff();
  return (way * middle_m - middle_m).norm() + Eigen::AngleAxisd(way.linear()).angle() * reach_m;
}

}  // namespace

double parts_for_obstacles(const Body& body, const ContactTerm& contact, const Eigen::Matrix3Xd& positions_m,
                           const Eigen::Matrix3Xd& velocities_m_s, const ContactState& state,
                           const FreeVelocities& free_velocities, double h) {
  const ContactPoints& points = contact.points();
  double parts = 1.0;
  if (points.count() == 0) return parts;
  const double smallest_m = points.least_face_size_m();
  const double bodys_way_m = h * velocities_m_s.colwise().norm().maxCoeff();
  for (std::size_t i = 0; i < body.obstacles().size(); ++i) {
    const Obstacle& obstacle = body.obstacles()[i];
    if (std::holds_alternative<Plane>(obstacle.shape)) continue;
    const double half_m = size_m(obstacle.shape);
    const Eigen::Isometry3d pose = contact.pose_of(static_cast<int>(i), state);
    const Eigen::Isometry3d way =
        pose_after(obstacle, static_cast<int>(i), contact, state, free_velocities, h) * pose.inverse();
    if (bodys_way_m + longest_m(way, positions_m) <= kMostWay * std::min(half_m, smallest_m)) continue;
    for (int point = 0; point < points.count(); ++point) {
      const Eigen::Vector3d at_m = points.at(point, positions_m);
      const double way_m = (h * points.at(point, velocities_m_s) - (way * at_m - at_m)).norm();
      const double allowed_m = kMostWay * std::min(half_m, points.face_size_m(point));
      if (way_m <= allowed_m || way_m - gap_to(obstacle.shape, pose, at_m).gap_m <= allowed_m) continue;
      parts = std::max(parts, way_m / allowed_m);
    }
  }
  return parts;
}

}  // namespace soft_robot_lab
