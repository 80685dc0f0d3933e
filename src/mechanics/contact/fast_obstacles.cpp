// SPDX-License-Identifier: BSD-3-Clause
#include "fast_obstacles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>
#include <vector>

#include "gap.h"
#include "swept_obstacles.h"

namespace soft_robot_lab {
namespace {

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

// Keeps what asks for most parts.
void ask(double way_m, double allowed_m, int obstacle, ObstacleCuts& cuts) {
  const double parts = way_m / allowed_m;
  if (parts <= cuts.parts) return;
  cuts = {std::isfinite(parts) ? parts : std::numeric_limits<double>::infinity(), way_m, obstacle};
}

// Whether what has this radius goes into the shape by more than `allowed_m` on a straight way. It is followed in steps
// of at least that; of a way of more steps than are taken only the first part is looked at.
bool goes_into(const ObstacleShape& shape, const Eigen::Isometry3d& pose, double radius_m,
               const Eigen::Vector3d& start_m, const Eigen::Vector3d& way_m, double allowed_m) {
  constexpr int kMostSteps = 10000;
  const double length_m = way_m.norm();
  double at_m = 0.0;
  for (int step = 0; step < kMostSteps && at_m < length_m; ++step) {
    const double gap_m = gap_to(shape, pose, start_m + at_m / length_m * way_m).gap_m - radius_m;
    if (gap_m < -allowed_m) return true;
    at_m += std::max(gap_m, allowed_m);
  }
  return false;
}

// What the obstacles of a step do.
struct ObstacleWays {
  std::vector<Eigen::Isometry3d> poses, ways;  // where it starts, and from there to where it would end
};

ObstacleWays ways_of(const Body& body, const ContactTerm& contact, const ContactState& state,
                     const FreeVelocities& free_velocities, double h) {
  ObstacleWays all;
  for (std::size_t i = 0; i < body.obstacles().size(); ++i) {
    const int index = static_cast<int>(i);
    all.poses.push_back(contact.pose_of(index, state));
    all.ways.push_back(pose_after(body.obstacles()[i], index, contact, state, free_velocities, h) *
                       all.poses.back().inverse());
  }
  return all;
}

void against_skin(const Body& body, const ContactPoints& points, const Eigen::Matrix3Xd& positions_m,
                  const Eigen::Matrix3Xd& velocities_m_s, const ObstacleWays& all, double h, ObstacleCuts& cuts) {
  if (points.count() == 0) return;
  const double smallest_m = points.least_face_size_m();
  const double bodys_way_m = h * velocities_m_s.colwise().norm().maxCoeff();
  for (std::size_t i = 0; i < body.obstacles().size(); ++i) {
    const Obstacle& obstacle = body.obstacles()[i];
    if (std::holds_alternative<Plane>(obstacle.shape)) continue;
    const Eigen::Isometry3d &pose = all.poses[i], &way = all.ways[i];
    if (bodys_way_m + longest_m(way, positions_m) <= allowed_depth_m(obstacle, smallest_m)) continue;
    for (int point = 0; point < points.count(); ++point) {
      const Eigen::Vector3d at_m = points.at(point, positions_m);
      const double way_m = (h * points.at(point, velocities_m_s) - (way * at_m - at_m)).norm();
      const double allowed_m = allowed_depth_m(obstacle, points.face_size_m(point));
      if (way_m <= allowed_m || way_m - gap_to(obstacle.shape, pose, at_m).gap_m <= allowed_m) continue;
      ask(way_m, allowed_m, static_cast<int>(i), cuts);
    }
  }
}

// Of each free obstacle its middle.
void against_one_another(const Body& body, const ContactTerm& contact, const ObstacleWays& all, ObstacleCuts& cuts) {
  for (std::size_t i = 0; i < body.obstacles().size(); ++i) {
    const Obstacle& free = body.obstacles()[i];
    if (contact.free().index_of(static_cast<int>(i)) < 0) continue;
    const Eigen::Vector3d start_m = all.poses[i] * center_m(free.shape), end_m = all.ways[i] * start_m;
    for (std::size_t k = 0; k < body.obstacles().size(); ++k) {
      const Obstacle& other = body.obstacles()[k];
      if (k == i || std::holds_alternative<Plane>(other.shape)) continue;
      const Eigen::Vector3d way_m = end_m - all.ways[k] * start_m;
      const double allowed_m = allowed_depth_m(other, size_m(free.shape));
      if (way_m.norm() <= cuts.parts * allowed_m) continue;
      if (!way_m.allFinite() || goes_into(other.shape, all.poses[k], size_m(free.shape), start_m, way_m, allowed_m))
        ask(way_m.norm(), allowed_m, static_cast<int>(i), cuts);
    }
  }
}

}  // namespace

ObstacleCuts parts_for_obstacles(const Body& body, const ContactTerm& contact, const Eigen::Matrix3Xd& positions_m,
                                 const Eigen::Matrix3Xd& velocities_m_s, const ContactState& state,
                                 const FreeVelocities& free_velocities, double h) {
  ObstacleCuts cuts;
  if (body.obstacles().empty()) return cuts;
  const ObstacleWays all = ways_of(body, contact, state, free_velocities, h);
  against_skin(body, contact.points(), positions_m, velocities_m_s, all, h, cuts);
  against_one_another(body, contact, all, cuts);
  return cuts;
}

}  // namespace soft_robot_lab
