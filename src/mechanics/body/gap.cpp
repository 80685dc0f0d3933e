// SPDX-License-Identifier: BSD-3-Clause
#include "gap.h"

#include <algorithm>
#include <cmath>

#include "mesh_solid.h"

namespace soft_robot_lab {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// A direction for points where none is better than another.
Vector3d any_across(const Vector3d& axis) { return axis.unitOrthogonal(); }

Matrix3d outer(const Vector3d& v) { return v * v.transpose(); }

Gap from_point(const Vector3d& offset, double radius_m) {
  const double distance = offset.norm();
  if (distance == 0.0) return {-radius_m, Vector3d::UnitZ(), Matrix3d::Zero()};
  const Vector3d normal = offset / distance;
  return {distance - radius_m, normal, (Matrix3d::Identity() - outer(normal)) / distance};
}

// A point seen from an axis: along it, and away from it.
struct FromAxis {
  double along, away;
  Vector3d axis, outward;

  FromAxis(const Vector3d& point, const Vector3d& middle, const Vector3d& axis_in) : axis(axis_in) {
    along = axis.dot(point - middle);
    const Vector3d across = point - middle - along * axis;
    away = across.norm();
    outward = away > 0.0 ? Vector3d(across / away) : any_across(axis);
  }
  // Second derivative of `away`.
  Matrix3d bend() const {
    if (away == 0.0) return Matrix3d::Zero();
    return (Matrix3d::Identity() - outer(axis) - outer(outward)) / away;
  }
};

Gap gap(const Plane& plane, const Vector3d& point) {
  const Vector3d normal = plane.normal.normalized();
  return {normal.dot(point - plane.point_m), normal, Matrix3d::Zero()};
}

Gap gap(const Sphere& sphere, const Vector3d& point) { return from_point(point - sphere.center_m, sphere.radius_m); }

Gap gap(const Capsule& capsule, const Vector3d& point) {
  const Vector3d along = capsule.end_m - capsule.start_m;
  const double share = along.dot(point - capsule.start_m) / along.squaredNorm();
  if (share <= 0.0) return from_point(point - capsule.start_m, capsule.radius_m);
  if (share >= 1.0) return from_point(point - capsule.end_m, capsule.radius_m);
  const FromAxis at(point, capsule.start_m, along.normalized());
  return {at.away - capsule.radius_m, at.outward, at.bend()};
}

Gap gap(const Cylinder& cylinder, const Vector3d& point) {
  const Vector3d along = cylinder.end_m - cylinder.start_m;
  const FromAxis at(point, 0.5 * (cylinder.start_m + cylinder.end_m), along.normalized());
  const double side = at.away - (cylinder.radius_m - cylinder.rounding_m);
  const double end = std::abs(at.along) - (0.5 * along.norm() - cylinder.rounding_m);
  const Vector3d endward = at.along < 0.0 ? Vector3d(-at.axis) : at.axis;
  if (side > 0.0 && end > 0.0) {  // at the rounded edge
    const double distance = std::hypot(side, end);
    const Vector3d normal = (side * at.outward + end * endward) / distance;
    const Matrix3d round = (outer(at.outward) + outer(at.axis) - outer(normal)) / distance;
    return {distance - cylinder.rounding_m, normal, round + side / distance * at.bend()};
  }
  if (side >= end) return {side - cylinder.rounding_m, at.outward, at.bend()};
  return {end - cylinder.rounding_m, endward, Matrix3d::Zero()};
}

Gap gap(const RoundedBox& box, const Vector3d& point) {
  const Vector3d offset = point - box.center_m;
  const Vector3d beyond = offset.cwiseAbs() - (0.5 * box.size_m - Vector3d::Constant(box.rounding_m));
  const Vector3d sign = (offset.array() < 0.0).select(-Vector3d::Ones(), Vector3d::Ones());
  const Vector3d outside = beyond.cwiseMax(0.0);
  const double distance = outside.norm();
  if (distance > 0.0) {
    const Vector3d normal = outside.cwiseProduct(sign) / distance;
    const Vector3d free = (beyond.array() > 0.0).select(Vector3d::Ones(), Vector3d::Zero());
    return {distance - box.rounding_m, normal, (Matrix3d(free.asDiagonal()) - outer(normal)) / distance};
  }
  Eigen::Index side;
  const double depth = beyond.maxCoeff(&side);
  return {depth - box.rounding_m, sign[side] * Vector3d::Unit(side), Matrix3d::Zero()};
}

Gap gap(const MeshShape& mesh, const Vector3d& point) { return mesh.solid->gap(point); }

Vector3d middle(const Plane& plane) { return plane.point_m; }
Vector3d middle(const Sphere& sphere) { return sphere.center_m; }
Vector3d middle(const Capsule& capsule) { return 0.5 * (capsule.start_m + capsule.end_m); }
Vector3d middle(const Cylinder& cylinder) { return 0.5 * (cylinder.start_m + cylinder.end_m); }
Vector3d middle(const RoundedBox& box) { return box.center_m; }
Vector3d middle(const MeshShape& mesh) { return mesh.solid->surface().centroid_m(); }

Eigen::Quaterniond turn(const Vector3d& rotation_rad) {
  const double angle = rotation_rad.norm();
  if (angle == 0.0) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, rotation_rad / angle));
}

// Between two poses: evenly about the one axis that leads from the first to the second.
ObstaclePose between(const ObstaclePose& from, const ObstaclePose& to, double share, Eigen::Quaterniond& rotation) {
  const Eigen::Quaterniond first = turn(from.rotation_rad);
  const Eigen::AngleAxisd rest(first.conjugate() * turn(to.rotation_rad));
  rotation = first * Eigen::AngleAxisd(share * rest.angle(), rest.axis());
  return {0.0, from.translation_m + share * (to.translation_m - from.translation_m), Vector3d::Zero()};
}

}  // namespace

Gap gap_to(const ObstacleShape& shape, const Eigen::Vector3d& point_m) {
  return std::visit([&](const auto& one) { return gap(one, point_m); }, shape);
}

bool is_flat(const ObstacleShape& shape) {
  const auto* mesh = std::get_if<MeshShape>(&shape);
  return mesh != nullptr ? mesh->solid->flat()
                         : std::holds_alternative<Plane>(shape) || std::holds_alternative<RoundedBox>(shape);
}

Eigen::Vector3d center_m(const ObstacleShape& shape) {
  return std::visit([](const auto& one) { return middle(one); }, shape);
}

Eigen::Isometry3d pose_at(const Obstacle& obstacle, double time_s) {
  return pose_at(obstacle.motion, center_m(obstacle.shape), time_s);
}

double end_of_motion_s(const std::vector<Obstacle>& obstacles) {
  double end_s = 0.0;
  for (const Obstacle& obstacle : obstacles)
    if (!obstacle.motion.empty()) end_s = std::max(end_s, obstacle.motion.back().time_s);
  return end_s;
}

bool any_moves_between(const std::vector<Obstacle>& obstacles, double from_s, double to_s) {
  return std::any_of(obstacles.begin(), obstacles.end(), [&](const Obstacle& obstacle) {
    return pose_at(obstacle, from_s).matrix() != pose_at(obstacle, to_s).matrix();
  });
}

Eigen::Isometry3d pose_at(const std::vector<ObstaclePose>& motion, const Vector3d& middle_m, double time_s) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  if (motion.empty()) return pose;
  const auto later =
      std::find_if(motion.begin(), motion.end(), [&](const ObstaclePose& at) { return at.time_s > time_s; });
  Eigen::Quaterniond rotation;
  Vector3d translation_m;
  if (later == motion.begin() || later == motion.end()) {
    const ObstaclePose& one = later == motion.end() ? motion.back() : motion.front();
    rotation = turn(one.rotation_rad);
    translation_m = one.translation_m;
  } else {
    const ObstaclePose& before = *(later - 1);
    const double share = (time_s - before.time_s) / (later->time_s - before.time_s);
    translation_m = between(before, *later, share, rotation).translation_m;
  }
  pose.linear() = rotation.toRotationMatrix();
  pose.translation() = middle_m + translation_m - pose.linear() * middle_m;
  return pose;
}

Eigen::Isometry3d way_between(const std::vector<ObstaclePose>& motion, const Vector3d& middle_m, double from_s,
                              double to_s) {
  return pose_at(motion, middle_m, to_s) * pose_at(motion, middle_m, from_s).inverse();
}

Vector3d turn_rad(const Eigen::Isometry3d& way) {
  const Eigen::AngleAxisd turn(way.linear());
  return turn.angle() * turn.axis();
}

Eigen::Isometry3d moved_about(const Vector3d& center_m, const Vector3d& way_m, const Vector3d& turn_rad) {
  return Eigen::Translation3d(center_m + way_m) * turn(turn_rad) * Eigen::Translation3d(-center_m);
}

Gap gap_to(const ObstacleShape& shape, const Eigen::Isometry3d& pose, const Eigen::Vector3d& point_m) {
  const Gap own = gap_to(shape, pose.linear().transpose() * (point_m - pose.translation()));
  return {own.gap_m, pose.linear() * own.normal, pose.linear() * own.hessian * pose.linear().transpose()};
}

}  // namespace soft_robot_lab
