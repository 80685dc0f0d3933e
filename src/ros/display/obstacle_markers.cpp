// SPDX-License-Identifier: BSD-3-Clause
#include "obstacle_markers.h"

#include <utility>

#include <Eigen/Geometry>

#include "ros/messages/conversions.h"
#include "ros/messages/frames.h"
#include "mechanics/body/mesh_solid.h"

namespace soft_robot_lab {
namespace {

using Eigen::Vector3d;
using Shape = visualization_msgs::Marker;

// One shape that rviz knows: in the frame of the obstacle as stated.
struct Primitive {
  int type;
  Vector3d center_m, size_m;
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  const MeshSolid* mesh = nullptr;  // of a list of triangles
};
using Primitives = std::vector<Primitive>;

Eigen::Quaterniond upright_to(const Vector3d& axis) {
  return Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), axis);
}

Primitive ball(const Vector3d& center_m, double radius_m) {
  return {Shape::SPHERE, center_m, Vector3d::Constant(2.0 * radius_m)};
}

Primitive rod(const Vector3d& start_m, const Vector3d& end_m, double radius_m) {
  const Vector3d along_m = end_m - start_m;
  return {
      Shape::CYLINDER, 0.5 * (start_m + end_m), {2.0 * radius_m, 2.0 * radius_m, along_m.norm()}, upright_to(along_m)};
}

Primitives primitives(const Plane& plane, double robot_m) {
  const double thick_m = 0.005 * robot_m;
  return {{Shape::CUBE,
           plane.point_m - 0.5 * thick_m * plane.normal.normalized(),
           {4.0 * robot_m, 4.0 * robot_m, thick_m},
           upright_to(plane.normal)}};
}
Primitives primitives(const Sphere& sphere, double /*robot_m*/) { return {ball(sphere.center_m, sphere.radius_m)}; }
Primitives primitives(const Capsule& capsule, double /*robot_m*/) {
  return {rod(capsule.start_m, capsule.end_m, capsule.radius_m), ball(capsule.start_m, capsule.radius_m),
          ball(capsule.end_m, capsule.radius_m)};
}
Primitives primitives(const Cylinder& cylinder, double /*robot_m*/) {
  return {rod(cylinder.start_m, cylinder.end_m, cylinder.radius_m)};
}
Primitives primitives(const RoundedBox& box, double /*robot_m*/) { return {{Shape::CUBE, box.center_m, box.size_m}}; }
Primitives primitives(const MeshShape& mesh, double /*robot_m*/) {
  return {{Shape::TRIANGLE_LIST, Vector3d::Zero(), Vector3d::Ones(), Eigen::Quaterniond::Identity(), mesh.solid.get()}};
}

void add_triangles(const ClosedSurface& surface, Shape& marker) {
  marker.points.reserve(static_cast<std::size_t>(3 * surface.count()));
  for (Eigen::Index t = 0; t < surface.count(); ++t)
    for (const int vertex : surface.triangles().col(t))
      marker.points.push_back(to_message(Vector3d(surface.vertices_m().col(vertex))));
}

Shape marker_of(const Primitive& primitive, const Eigen::Isometry3d& pose, bool free) {
  Shape marker;
  marker.type = primitive.type;
  marker.pose.position = to_message(pose * primitive.center_m);
  const Eigen::Quaterniond turn(pose.linear() * primitive.turn.toRotationMatrix());
  marker.pose.orientation = to_message(turn);
  marker.scale.x = primitive.size_m.x();
  marker.scale.y = primitive.size_m.y();
  marker.scale.z = primitive.size_m.z();
  marker.color.r = free ? 0.90f : 0.55f;
  marker.color.g = free ? 0.65f : 0.58f;
  marker.color.b = free ? 0.25f : 0.62f;
  marker.color.a = free || primitive.mesh != nullptr ? 1.0f : 0.7f;  // rviz does not sort a mesh's triangles by depth
  if (primitive.mesh != nullptr) add_triangles(primitive.mesh->surface(), marker);
  return marker;
}

}  // namespace

visualization_msgs::MarkerArray obstacle_markers(const Simulation& simulation, const ros::Time& stamp) {
  visualization_msgs::MarkerArray array;
  Shape clear;
  clear.action = Shape::DELETEALL;
  array.markers.push_back(clear);
  const std::vector<Eigen::Isometry3d> poses = simulation.obstacle_poses();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Obstacle& obstacle = simulation.body().obstacles()[i];
    const Primitives shapes =
        std::visit([&](const auto& shape) { return primitives(shape, simulation.body().size_m()); }, obstacle.shape);
    for (std::size_t k = 0; k < shapes.size(); ++k) {
      array.markers.push_back(marker_of(shapes[k], poses[i], obstacle.is_free()));
      array.markers.back().ns = obstacle.name;
      array.markers.back().id = static_cast<int>(k);
    }
  }
  for (Shape& marker : array.markers) {
    marker.header.frame_id = robot_frame();
    marker.header.stamp = stamp;
  }
  return array;
}

}  // namespace soft_robot_lab
