// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/mechanics/obstacle.h"

#include <cmath>
#include <sstream>
#include <stdexcept>

#include <Eigen/Cholesky>

#include "mesh_solid.h"
#include "settings/limits.h"

namespace soft_robot_lab {
namespace {

[[noreturn]] void refuse(const std::string& field, double value, const std::string& range) {
  std::ostringstream message;
  message << field << ": " << value << " is out of range " << range;
  throw std::invalid_argument(message.str());
}

void require_positive(const std::string& field, double value) {
  if (!(value > 0.0) || !std::isfinite(value)) refuse(field, value, "(0, inf)");
}

void require_finite(const std::string& field, const Eigen::Vector3d& value) {
  if (!value.allFinite()) throw std::invalid_argument(field + ": not finite");
}

void require_length(const Eigen::Vector3d& start_m, const Eigen::Vector3d& end_m) {
  require_finite("start_m", start_m);
  require_finite("end_m", end_m);
  if (!((end_m - start_m).norm() > 0.0)) throw std::invalid_argument("end_m: is where start_m is; must differ");
}

void require_rounding(double rounding_m, double most_m) {
  if (rounding_m > 0.0 && rounding_m <= most_m) return;
  std::ostringstream range;
  range << "(0, " << most_m << "], by the size of the shape";
  refuse("rounding_m", rounding_m, range.str());
}

void check(const Plane& plane) {
  require_finite("point_m", plane.point_m);
  require_finite("normal", plane.normal);
  require_positive("normal: its length", plane.normal.norm());
}

void check(const Sphere& sphere) {
  require_finite("center_m", sphere.center_m);
  require_positive("radius_m", sphere.radius_m);
}

void check(const Capsule& capsule) {
  require_length(capsule.start_m, capsule.end_m);
  require_positive("radius_m", capsule.radius_m);
}

void check(const Cylinder& cylinder) {
  require_length(cylinder.start_m, cylinder.end_m);
  require_positive("radius_m", cylinder.radius_m);
  const double half_m = 0.5 * (cylinder.end_m - cylinder.start_m).norm();
  require_rounding(cylinder.rounding_m, std::min(cylinder.radius_m, half_m));
}

void check(const RoundedBox& box) {
  require_finite("center_m", box.center_m);
  for (int axis = 0; axis < 3; ++axis) require_positive("size_m", box.size_m[axis]);
  require_rounding(box.rounding_m, 0.5 * box.size_m.minCoeff());
}

void check(const MeshShape& mesh) {
  if (!mesh.solid) throw std::invalid_argument("mesh: is none; mesh_shape() makes one");
}

void require_few_corners(const MeshSolid& solid) {
  const auto corners = solid.corners_m().cols();
  if (corners > limits::kMeshCorners)
    throw std::invalid_argument("mesh: has " + std::to_string(corners) + " corners that stand out, at most " +
                                std::to_string(limits::kMeshCorners) +
                                " may touch others; make its mesh coarser, or give it no mass_kg");
}

void check_free(const Obstacle& one) {
  if (!(one.mass_kg >= 0.0) || !std::isfinite(one.mass_kg)) refuse("mass_kg", one.mass_kg, "(0, inf)");
  require_finite("velocity_m_s", one.velocity_m_s);
  require_finite("angular_velocity_rad_s", one.angular_velocity_rad_s);
  for (const auto& [name, coefficient] : one.friction_on)
    if (!(coefficient >= 0.0) || !std::isfinite(coefficient)) refuse("friction on " + name, coefficient, "[0, inf)");
  if (!one.is_free()) {
    if (one.inertia_kg_m2 || !one.velocity_m_s.isZero(0.0) || !one.angular_velocity_rad_s.isZero(0.0))
      throw std::invalid_argument("inertia and velocity are for free obstacles: give mass_kg too");
    return;
  }
  if (!one.motion.empty()) throw std::invalid_argument("motion: a free obstacle, with mass_kg, moves by itself");
  if (std::holds_alternative<Plane>(one.shape)) throw std::invalid_argument("mass_kg: a plane cannot be free");
  if (const auto* mesh = std::get_if<MeshShape>(&one.shape)) require_few_corners(*mesh->solid);
  if (!one.inertia_kg_m2) return;
  const Eigen::Matrix3d& inertia = *one.inertia_kg_m2;
  const bool positive = inertia.allFinite() && inertia == inertia.transpose() &&
                        Eigen::LLT<Eigen::Matrix3d>(inertia).info() == Eigen::Success;
  if (!positive) throw std::invalid_argument("inertia_kg_m2: must be symmetric and positive");
}

// About one axis, where the sense is meant; poses that are apart by more have a shorter way the other way round.
void require_half_a_turn(const std::string& field, const Eigen::Vector3d& from_rad, const Eigen::Vector3d& to_rad) {
  constexpr double pi = 3.14159265358979323846, close = 1e-6;
  const double turn_rad = (to_rad - from_rad).norm();
  const bool one_axis = from_rad.cross(to_rad).norm() <= close * from_rad.norm() * to_rad.norm();
  if (!one_axis || turn_rad <= (1.0 + close) * pi) return;
  std::ostringstream message;
  message << field << ": turns by " << turn_rad << " rad from the pose before, out of range [0, pi], "
          << "as the shorter way round is taken; add poses between";
  throw std::invalid_argument(message.str());
}

}  // namespace

MeshShape mesh_shape(const Eigen::Matrix3Xd& vertices_m, const Eigen::Matrix3Xi& triangles, double rounding_m) {
  if (!(rounding_m >= 0.0) || !std::isfinite(rounding_m)) refuse("rounding_m", rounding_m, "[0, inf)");
  return {std::make_shared<const MeshSolid>(vertices_m, triangles, rounding_m)};
}

void validate_motion(const std::vector<ObstaclePose>& motion) {
  for (std::size_t i = 0; i < motion.size(); ++i) {
    const std::string item = "motion[" + std::to_string(i) + "].";
    if (!(motion[i].time_s >= 0.0) || !std::isfinite(motion[i].time_s))
      refuse(item + "time_s", motion[i].time_s, "[0, inf)");
    if (i > 0 && !(motion[i].time_s > motion[i - 1].time_s))
      refuse(item + "time_s", motion[i].time_s, "of times that rise from pose to pose: nothing jumps");
    require_finite(item + "translation_m", motion[i].translation_m);
    require_finite(item + "rotation_rad", motion[i].rotation_rad);
    if (i > 0) require_half_a_turn(item + "rotation_rad", motion[i - 1].rotation_rad, motion[i].rotation_rad);
  }
}

void Obstacle::validate() const {
  std::visit([](const auto& one) { check(one); }, shape);
  validate_motion(motion);
  if (!(friction >= 0.0) || !std::isfinite(friction)) refuse("friction", friction, "[0, inf)");
  check_free(*this);
}

}  // namespace soft_robot_lab
