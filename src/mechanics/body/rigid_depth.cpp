// SPDX-License-Identifier: BSD-3-Clause
#include "rigid_depth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "free_obstacles.h"
#include "gap.h"
#include "mesh_solid.h"
#include "rigid_features.h"

namespace soft_robot_lab {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kAllowed = 0.1;          // of half the least extent
constexpr double kAllowedOfStep = 0.5;    // of the rounding of a mesh
constexpr double kShortestStride = 0.25;  // of the allowed depth
constexpr int kCuts = 60;                 // with which things are found in one another of which no edge is inside
constexpr double kDirection = 0.5;        // of its length: shorter ones are none

// How far a shape reaches along a direction of length 1, in the frame in which it is stated.
double reach_m(const Plane& /*endless*/, const Vector3d& /*way*/) { return std::numeric_limits<double>::infinity(); }
double reach_m(const Sphere& sphere, const Vector3d& way) { return way.dot(sphere.center_m) + sphere.radius_m; }
double reach_m(const Capsule& capsule, const Vector3d& way) {
  return std::max(way.dot(capsule.start_m), way.dot(capsule.end_m)) + capsule.radius_m;
}
double reach_m(const Cylinder& cylinder, const Vector3d& way) {
  const Vector3d axis = (cylinder.end_m - cylinder.start_m).normalized(), inwards_m = cylinder.rounding_m * axis;
  const double along = way.dot(axis), across = std::sqrt(std::max(0.0, 1.0 - along * along));
  return std::max(way.dot(cylinder.start_m + inwards_m), way.dot(cylinder.end_m - inwards_m)) +
         (cylinder.radius_m - cylinder.rounding_m) * across + cylinder.rounding_m;
}
double reach_m(const RoundedBox& box, const Vector3d& way) {
  const Vector3d core_m = 0.5 * box.size_m - Vector3d::Constant(box.rounding_m);
  return way.dot(box.center_m) + way.cwiseAbs().dot(core_m) + box.rounding_m;
}
double reach_m(const MeshShape& mesh, const Vector3d& way) {
  const Eigen::Matrix3Xd& corners_m = mesh.solid->corners_m();
  return corners_m.cols() > 0 ? (way.transpose() * corners_m).maxCoeff() : std::numeric_limits<double>::infinity();
}

double reach_m(const PlacedShape& placed, const Vector3d& way) {
  const Vector3d own_way = placed.pose.linear().transpose() * way;
  return std::visit([&](const auto& shape) { return reach_m(shape, own_way); }, placed.shape) +
         way.dot(placed.pose.translation());
}

// How far they are apart along a direction that leads from the other to the one.
double apart_along_m(const PlacedShape& one, const PlacedShape& other, const Vector3d& way) {
  return -reach_m(one, -way) - reach_m(other, way);
}

// Directions in which a shape is short, if any: a box's faces, a cylinder's ends.
struct Axes {
  int count = 0;
  Matrix3d ways = Matrix3d::Identity();
};

Axes axes_of(const PlacedShape& placed) {
  Axes axes;
  if (std::holds_alternative<RoundedBox>(placed.shape)) {
    axes = {3, placed.pose.linear()};
  } else if (const auto* cylinder = std::get_if<Cylinder>(&placed.shape)) {
    axes.count = 1;
    axes.ways.col(0) = placed.pose.linear() * (cylinder->end_m - cylinder->start_m).normalized();
  }
  return axes;
}

// Whether one of a few planes lies between them, or no deeper in them than allowed.
bool plane_between(const PlacedShape& one, const PlacedShape& other, double allowed_m) {
  const auto along = [&](const Vector3d& way) {
    const double length = way.norm();
    return length > kDirection && apart_along_m(one, other, way / length) >= -allowed_m;
  };
  const auto along_either = [&](const Vector3d& way) { return along(way) || along(-way); };
  const Vector3d one_m = one.pose * center_m(one.shape), other_m = other.pose * center_m(other.shape);
  if (along(gap_to(other.shape, other.pose, one_m).normal) || along(-gap_to(one.shape, one.pose, other_m).normal))
    return true;
  const Vector3d way_m = one_m - other_m;
  if (way_m.norm() > 0.0 && along(way_m.normalized())) return true;
  const Axes own = axes_of(one), theirs = axes_of(other);
  for (const Axes& axes : {own, theirs})
    for (int i = 0; i < axes.count; ++i)
      if (along_either(axes.ways.col(i))) return true;
  for (int i = 0; i < own.count; ++i)
    for (int k = 0; k < theirs.count; ++k) {
      const Vector3d square = own.ways.col(i).cross(theirs.ways.col(k));
      if (square.norm() > 1e-6 && along_either(square.normalized())) return true;
    }
  return false;
}

// Of places along a curve, whose depth changes by no more than the way between them: none deeper than allowed is
// passed over by more than a quarter of that.
template <class DepthAt>
double deepest_along_m(double length_m, double allowed_m, const DepthAt& depth_at_m) {
  double deepest_m = 0.0;
  for (double at_m = 0.0; at_m <= length_m;) {
    const double depth_m = depth_at_m(at_m);
    deepest_m = std::max(deepest_m, depth_m);
    at_m += std::max(allowed_m - depth_m, kShortestStride * allowed_m);
  }
  return deepest_m;
}

// Of what one shape touches with, in another one.
double deepest_m(const Features& features, const Isometry3d& pose, const PlacedShape& in, double allowed_m) {
  const auto depth_m = [&](const Vector3d& at_m, double radius_m) -> double {
    return radius_m - gap_of_ball(in.shape, in.pose, pose * at_m, radius_m).gap_m;
  };
  double most_m = 0.0;
  for (const RoundedPoint& point : features.points)
    most_m = std::max(most_m, depth_m(point.position_m, point.radius_m));
  for (const RoundedLine& line : features.lines) {
    const double length_m = (line.to_m - line.from_m).norm();
    // Balls about the axis of a short cylinder are in it only where they are smaller.
    const double radius_m = line.flat_ends ? std::min(line.radius_m, 0.5 * length_m) : line.radius_m;
    const double from_end_m = line.flat_ends ? radius_m : 0.0;
    const Vector3d along = (line.to_m - line.from_m) / length_m, from_m = line.from_m + from_end_m * along;
    most_m = std::max(most_m, deepest_along_m(length_m - 2.0 * from_end_m, allowed_m,
                                              [&](double way_m) { return depth_m(from_m + way_m * along, radius_m); }));
  }
  for (const RoundedRim& rim : features.rims) {
    const Vector3d across = rim.outward.unitOrthogonal();
    most_m = std::max(most_m, deepest_along_m(2.0 * M_PI * rim.radius_m, allowed_m, [&](double way_m) {
                        const Vector3d out_m = radius_at_m(rim, across, way_m / rim.radius_m);
                        return depth_m(rim.middle_m + out_m, rim.rounding_m);
                      }));
  }
  return most_m;
}

bool is_a_mesh(const ObstacleShape& shape) { return std::holds_alternative<MeshShape>(shape); }

double more_of_mesh_m(const ObstacleShape& shape) {
  const auto* mesh = std::get_if<MeshShape>(&shape);
  return mesh == nullptr ? 0.0 : kAllowedOfStep * mesh->solid->rounding_m();
}

}  // namespace

double allowed_overlap_m(const ObstacleShape& one, const ObstacleShape& other) {
  return kAllowed * std::min(size_m(one), size_m(other)) + std::max(more_of_mesh_m(one), more_of_mesh_m(other));
}

double depth_beyond_m(const PlacedShape& one, const PlacedShape& other, double allowed_m) {
  if (spheres_apart_m(one, other) > 0.0) return 0.0;
  double depth_m = 0.0;
  if (const auto* plane = std::get_if<Plane>(&other.shape)) {
    const Vector3d way = other.pose.linear() * plane->normal.normalized();
    depth_m = way.dot(other.pose * plane->point_m) + reach_m(one, -way);
  } else if (!plane_between(one, other, allowed_m)) {
    depth_m = is_a_mesh(one.shape) || is_a_mesh(other.shape)
                  ? std::max({-apart_by_cuts_m(one, other, kCuts),
                              deepest_m(features_of(one.shape), one.pose, other, allowed_m),
                              deepest_m(features_of(other.shape), other.pose, one, allowed_m)})
                  : -apart_m(one, other);
  }
  return depth_m > allowed_m ? depth_m : 0.0;
}

}  // namespace soft_robot_lab
