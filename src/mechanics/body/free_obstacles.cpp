// SPDX-License-Identifier: BSD-3-Clause
#include "free_obstacles.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gap.h"
#include "mesh_solid.h"

namespace soft_robot_lab {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d about_axis(const Vector3d& axis, double along, double across) {
  const Matrix3d outer = axis * axis.transpose();
  return along * outer + across * (Matrix3d::Identity() - outer);
}

Matrix3d inertia(const Plane& /*never free*/, double /*mass_kg*/) { return Matrix3d::Identity(); }

Matrix3d inertia(const Sphere& sphere, double mass_kg) {
  return 0.4 * mass_kg * sphere.radius_m * sphere.radius_m * Matrix3d::Identity();
}

Matrix3d inertia(const Capsule& capsule, double mass_kg) {
  const double r = capsule.radius_m, length = (capsule.end_m - capsule.start_m).norm();
  const double tube = mass_kg * length / (length + 4.0 / 3.0 * r), ball = mass_kg - tube;
  const double along = 0.5 * tube * r * r + 0.4 * ball * r * r;
  const double across = tube * (r * r / 4.0 + length * length / 12.0) +
                        ball * (0.4 * r * r + 0.25 * length * length + 0.375 * length * r);
  return about_axis((capsule.end_m - capsule.start_m).normalized(), along, across);
}

Matrix3d inertia(const Cylinder& cylinder, double mass_kg) {
  const double r = cylinder.radius_m, length = (cylinder.end_m - cylinder.start_m).norm();
  return about_axis((cylinder.end_m - cylinder.start_m).normalized(), 0.5 * mass_kg * r * r,
                    mass_kg * (r * r / 4.0 + length * length / 12.0));
}

Matrix3d inertia(const RoundedBox& box, double mass_kg) {
  const Vector3d squares = box.size_m.cwiseAbs2();
  return (mass_kg / 12.0 * (Vector3d::Constant(squares.sum()) - squares)).asDiagonal();
}

Matrix3d inertia(const MeshShape& mesh, double mass_kg) {
  return mass_kg / mesh.solid->surface().volume_m3() * mesh.solid->surface().inertia_m5();
}

double volume(const Plane& /*endless*/) { return std::numeric_limits<double>::infinity(); }
double volume(const Sphere& sphere) { return 4.0 / 3.0 * M_PI * std::pow(sphere.radius_m, 3); }
double volume(const Capsule& capsule) {
  const double length_m = (capsule.end_m - capsule.start_m).norm();
  return M_PI * std::pow(capsule.radius_m, 2) * (length_m + 4.0 / 3.0 * capsule.radius_m);
}
double volume(const Cylinder& cylinder) {
  return M_PI * std::pow(cylinder.radius_m, 2) * (cylinder.end_m - cylinder.start_m).norm();
}
double volume(const RoundedBox& box) { return box.size_m.prod(); }
double volume(const MeshShape& mesh) { return mesh.solid->surface().volume_m3(); }

double size(const Plane& /*endless*/) { return 1.0; }
double size(const Sphere& sphere) { return sphere.radius_m; }
double size(const Capsule& capsule) { return capsule.radius_m; }
double size(const Cylinder& cylinder) {
  return std::min(cylinder.radius_m, 0.5 * (cylinder.end_m - cylinder.start_m).norm());
}
double size(const RoundedBox& box) { return 0.5 * box.size_m.minCoeff(); }
double size(const MeshShape& mesh) { return mesh.solid->half_thickness_m(); }

Eigen::Quaterniond quaternion(const Eigen::Vector4d& turn) { return Eigen::Quaterniond(turn); }

}  // namespace

Matrix3d solid_inertia_kg_m2(const ObstacleShape& shape, double mass_kg) {
  return std::visit([&](const auto& one) { return inertia(one, mass_kg); }, shape);
}

double volume_m3(const ObstacleShape& shape) {
  return std::visit([](const auto& one) { return volume(one); }, shape);
}

double size_m(const ObstacleShape& shape) {
  return std::visit([](const auto& one) { return size(one); }, shape);
}

Vector3d turned_rad(const Eigen::Vector4d& from, const Eigen::Vector4d& to) {
  Eigen::Quaterniond turn = quaternion(to) * quaternion(from).conjugate();
  if (turn.w() < 0.0) turn.coeffs() = -turn.coeffs();
  const double sine = turn.vec().norm();
  if (sine < 1e-12) return 2.0 * turn.vec();
  return 2.0 * std::atan2(sine, turn.w()) / sine * turn.vec();
}

Eigen::Vector4d turn_by(const Vector3d& rotation_rad, const Eigen::Vector4d& from) {
  const double angle = rotation_rad.norm();
  if (angle == 0.0) return from;
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle, rotation_rad / angle));
  return (turn * quaternion(from)).normalized().coeffs();
}

FreeObstacles::FreeObstacles(const std::vector<Obstacle>& obstacles, const Vector3d& gravity_m_s2)
    : gravity_m_s2_(gravity_m_s2) {
  const auto frees =
      std::count_if(obstacles.begin(), obstacles.end(), [](const Obstacle& one) { return one.is_free(); });
  start_.centers_m.resize(3, frees);
  start_.turns = Eigen::Vector4d::UnitW().replicate(1, frees);
  velocities_ = {Eigen::Matrix3Xd(3, frees), Eigen::Matrix3Xd(3, frees)};
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    const Obstacle& one = obstacles[i];
    of_obstacle_.push_back(one.is_free() ? count() : -1);
    if (!one.is_free()) continue;
    const Eigen::Index column = count();
    start_.centers_m.col(column) = center_m(one.shape);
    velocities_.linear_m_s.col(column) = one.velocity_m_s;
    velocities_.angular_rad_s.col(column) = one.angular_velocity_rad_s;
    obstacle_of_.push_back(static_cast<int>(i));
    masses_kg_.push_back(one.mass_kg);
    sizes_m_.push_back(soft_robot_lab::size_m(one.shape));
    inertias_kg_m2_.push_back(one.inertia_kg_m2 ? *one.inertia_kg_m2 : solid_inertia_kg_m2(one.shape, one.mass_kg));
  }
}

int FreeObstacles::index_of(int obstacle) const { return of_obstacle_[static_cast<std::size_t>(obstacle)]; }

double FreeObstacles::weight_n() const {
  double sum_kg = 0.0;
  for (const double mass_kg : masses_kg_) sum_kg += mass_kg;
  return sum_kg * gravity_m_s2_.norm();
}

FreePoses FreeObstacles::at_start() const { return start_; }
FreeVelocities FreeObstacles::velocities_at_start() const { return velocities_; }

Eigen::Isometry3d FreeObstacles::pose(int free, const FreePoses& poses) const {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = quaternion(poses.turns.col(free)).toRotationMatrix();
  pose.translation() = poses.centers_m.col(free) - pose.linear() * start_.centers_m.col(free);
  return pose;
}

Matrix3d FreeObstacles::inertia_kg_m2(int free, const Eigen::Vector4d& turn) const {
  const Matrix3d turned = quaternion(turn).toRotationMatrix();
  return turned * inertias_kg_m2_[static_cast<std::size_t>(free)] * turned.transpose();
}

FreePoses moved(const FreePoses& from, const FreeColumns& motion) {
  FreePoses to = from;
  for (Eigen::Index i = 0; i < from.centers_m.cols(); ++i) {
    to.centers_m.col(i) += motion.col(2 * i);
    to.turns.col(i) = turn_by(motion.col(2 * i + 1), from.turns.col(i));
  }
  return to;
}

}  // namespace soft_robot_lab
