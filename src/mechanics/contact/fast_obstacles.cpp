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

// How an obstacle moves in a step: its middle, and a turn about that, which may be several whole ones.
struct ObstacleWay {
  Eigen::Isometry3d pose;  // where it starts
  Eigen::Vector3d middle_m, move_m, turn_rad;

  // No point as far as this from the middle moves further.
  double longest_m(double reach_m) const { return move_m.norm() + turn_rad.norm() * reach_m; }
  Eigen::Isometry3d after(double share) const { return moved_about(middle_m, share * move_m, share * turn_rad) * pose; }
  // What a point would move that is fixed to it. More than half a turn says little of how far it came on the way.
  Eigen::Vector3d way_m(const Eigen::Vector3d& point_m) const {
    const Eigen::Vector3d arm_m = point_m - middle_m;
    if (turn_rad.norm() > M_PI) return move_m + turn_rad.cross(arm_m);
    return moved_about(middle_m, move_m, turn_rad) * point_m - point_m;
  }
};

ObstacleWay way_of(const Obstacle& obstacle, int index, const ContactTerm& contact, const ContactState& state,
                   const FreeVelocities& velocities, double h) {
  const Eigen::Isometry3d pose = contact.pose_of(index, state);
  const Eigen::Vector3d middle_m = pose * center_m(obstacle.shape);
  if (const int free = contact.free().index_of(index); free >= 0)
    return {pose, middle_m, h * velocities.linear_m_s.col(free), h * velocities.angular_rad_s.col(free)};
  const Eigen::Isometry3d way = pose_at(obstacle, state.time_s + h) * pose.inverse();
  return {pose, middle_m, way * middle_m - middle_m, turn_rad(way)};
}

// From a point, to the farthest node.
double reach_m(const Eigen::Vector3d& from_m, const Eigen::Matrix3Xd& positions_m) {
  return (positions_m.colwise() - from_m).colwise().norm().maxCoeff();
}

// Keeps what asks for most parts.
void ask(double way_m, double allowed_m, int obstacle, ObstacleCuts& cuts) {
  const double parts = way_m / allowed_m;
  if (parts <= cuts.parts) return;
  cuts = {std::isfinite(parts) ? parts : std::numeric_limits<double>::infinity(), way_m, obstacle};
}

// An obstacle after a share of how it moves.
PlacedShape placed(const Obstacle& obstacle, const ObstacleWay& way, double share) {
  return {obstacle.shape, way.after(share)};
}

std::vector<ObstacleWay> ways_of(const Body& body, const ContactTerm& contact, const ContactState& state,
                                 const FreeVelocities& free_velocities, double h) {
  std::vector<ObstacleWay> all;
  for (std::size_t i = 0; i < body.obstacles().size(); ++i)
    all.push_back(way_of(body.obstacles()[i], static_cast<int>(i), contact, state, free_velocities, h));
  return all;
}

void against_skin(const Body& body, const ContactPoints& points, const Eigen::Matrix3Xd& positions_m,
                  const Eigen::Matrix3Xd& velocities_m_s, const std::vector<ObstacleWay>& all, double h,
                  ObstacleCuts& cuts) {
  if (points.count() == 0) return;
  const double smallest_m = points.least_face_size_m();
  const double bodys_way_m = h * velocities_m_s.colwise().norm().maxCoeff();
  for (std::size_t i = 0; i < body.obstacles().size(); ++i) {
    const Obstacle& obstacle = body.obstacles()[i];
    if (std::holds_alternative<Plane>(obstacle.shape)) continue;
    const ObstacleWay& way = all[i];
    if (bodys_way_m + way.longest_m(reach_m(way.middle_m, positions_m)) <= allowed_depth_m(obstacle, smallest_m))
      continue;
    for (int point = 0; point < points.count(); ++point) {
      const Eigen::Vector3d at_m = points.at(point, positions_m);
      const double way_m = (h * points.at(point, velocities_m_s) - way.way_m(at_m)).norm();
      const double allowed_m = allowed_depth_m(obstacle, points.face_size_m(point));
      if (way_m <= allowed_m || way_m - gap_to(obstacle.shape, way.pose, at_m).gap_m <= allowed_m) continue;
      ask(way_m, allowed_m, static_cast<int>(i), cuts);
    }
  }
}

// Whether two obstacles go into one another by more than `allowed_m`. They are followed in steps of at least that; of a
// way of more steps than are taken only the first part is looked at.
bool go_into(const Body& body, const std::vector<ObstacleWay>& all, std::size_t one, std::size_t other, double way_m,
             double allowed_m) {
  constexpr int kMostSteps = 2000;
  const std::vector<Obstacle>& obstacles = body.obstacles();
  double share = 0.0;
  for (int step = 0; step < kMostSteps && share < 1.0; ++step) {
    const double gap_m = apart_m(placed(obstacles[one], all[one], share), placed(obstacles[other], all[other], share));
    if (gap_m < -allowed_m) return true;
    share += std::max(gap_m, allowed_m) / way_m;
  }
  return false;
}

// No point of one obstacle moves further against one of the other.
double longest_m(const Body& body, const std::vector<ObstacleWay>& all, std::size_t one, std::size_t other) {
  const auto turn_m = [&](std::size_t index) {
    return all[index].turn_rad.norm() * bounding_radius_m(body.obstacles()[index].shape);
  };
  return (all[one].move_m - all[other].move_m).norm() + turn_m(one) + turn_m(other);
}

void against_one_another(const Body& body, const std::vector<ObstacleWay>& all, ObstacleCuts& cuts) {
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
  const std::vector<ObstacleWay> all = ways_of(body, contact, state, free_velocities, h);
  against_skin(body, contact.points(), positions_m, velocities_m_s, all, h, cuts);
  against_one_another(body, all, cuts);
  return cuts;
}

}  // namespace soft_robot_lab
