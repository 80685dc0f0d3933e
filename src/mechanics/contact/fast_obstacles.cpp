// SPDX-License-Identifier: BSD-3-Clause
#include "fast_obstacles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>
#include <vector>

#include "mechanics/body/gap.h"
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

// What the obstacles of a step do.
struct ObstacleWays {
  std::vector<Eigen::Isometry3d> poses, ways;  // where it starts, and from there to where it would end
};

// An obstacle after a share of how it moves.
PlacedShape placed(const Obstacle& obstacle, const ObstacleWays& all, std::size_t index, double share) {
  const Eigen::Isometry3d& way = all.ways[index];
  const Eigen::Vector3d middle_m = all.poses[index] * center_m(obstacle.shape);
  const Eigen::AngleAxisd turn(way.linear());
  return {obstacle.shape,
          moved_about(middle_m, share * (way * middle_m - middle_m), share * turn.angle() * turn.axis()) *
              all.poses[index]};
}

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

// Whether two obstacles go into one another by more than `allowed_m`. They are followed in steps of at least that; of a
// way of more steps than are taken only the first part is looked at.
bool go_into(const Body& body, const ObstacleWays& all, std::size_t one, std::size_t other, double way_m,
             double allowed_m) {
  constexpr int kMostSteps = 2000;
  const std::vector<Obstacle>& obstacles = body.obstacles();
  double share = 0.0;
  for (int step = 0; step < kMostSteps && share < 1.0; ++step) {
    const double gap_m = apart_m(placed(obstacles[one], all, one, share), placed(obstacles[other], all, other, share));
    if (gap_m < -allowed_m) return true;
    share += std::max(gap_m, allowed_m) / way_m;
  }
  return false;
}

// No point of one obstacle moves further against one of the other.
double longest_m(const Body& body, const ObstacleWays& all, std::size_t one, std::size_t other) {
  const auto turn_m = [&](std::size_t index) {
    return Eigen::AngleAxisd(all.ways[index].linear()).angle() * bounding_radius_m(body.obstacles()[index].shape);
  };
  const auto way_m = [&](std::size_t index) -> Eigen::Vector3d {
    const Eigen::Vector3d middle_m = all.poses[index] * center_m(body.obstacles()[index].shape);
    return all.ways[index] * middle_m - middle_m;
  };
  return (way_m(one) - way_m(other)).norm() + turn_m(one) + turn_m(other);
}

void against_one_another(const Body& body, const ObstacleWays& all, ObstacleCuts& cuts) {
  const std::vector<Obstacle>& obstacles = body.obstacles();
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    for (std::size_t k = 0; k < obstacles.size(); ++k) {
      if (!obstacles[i].is_free() || k == i || (obstacles[k].is_free() && k < i)) continue;
      if (std::holds_alternative<Plane>(obstacles[k].shape)) continue;
      const double way_m = longest_m(body, all, i, k),
                   allowed_m = allowed_depth_m(obstacles[k], size_m(obstacles[i].shape));
      if (way_m <= cuts.parts * allowed_m) continue;
      if (!std::isfinite(way_m) || go_into(body, all, i, k, way_m, allowed_m))
        ask(way_m, allowed_m, static_cast<int>(i), cuts);
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
  against_one_another(body, all, cuts);
  return cuts;
}

}  // namespace soft_robot_lab
