// SPDX-License-Identifier: BSD-3-Clause
#include "overlap.h"

#include <sstream>
#include <stdexcept>

#include "contact_points.h"
#include "free_obstacles.h"
#include "gap.h"
#include "mesh_solid.h"
#include "rigid_places.h"
#include "settings/point_text.h"
#include "mechanics/mesh/skin.h"
#include "soft_robot_lab/mechanics/embedding.h"

namespace soft_robot_lab {
namespace {

constexpr double kRounding = 0.01;          // of a face's size
constexpr double kRoundingOfBodies = 1e-4;  // of the size of all
constexpr double kOverlap = 0.01;           // of a free obstacle's size: so deep may it be in another one

// Of a mesh by its triangles: its inner edges are rounded, and skin fits into them.
double depth_in_m(const Obstacle& obstacle, const Eigen::Isometry3d& pose, const Eigen::Vector3d& at_m) {
  const double rounded_m = -gap_to(obstacle.shape, pose, at_m).gap_m;
  const auto* mesh = std::get_if<MeshShape>(&obstacle.shape);
  return mesh == nullptr || rounded_m <= 0.0 ? rounded_m : -mesh->solid->sharp_gap_m(pose.inverse() * at_m);
}

// The skin, at its contact points and nodes.
void refuse_skin_inside(const Body& body, const ContactPoints& points, const Obstacle& obstacle) {
  const Eigen::Isometry3d pose = pose_at(obstacle, 0.0);
  double deepest_m = 0.0;
  Eigen::Vector3d where_m = Eigen::Vector3d::Zero();
  const auto look = [&](const Eigen::Vector3d& at, double face_size_m) {
    const double depth_m = depth_in_m(obstacle, pose, at);
    if (depth_m <= kRounding * face_size_m || depth_m <= deepest_m) return;
    deepest_m = depth_m;
    where_m = at;
  };
  const Eigen::Matrix3Xd& nodes_m = body.mesh().nodes_m;
  for (int point = 0; point < points.count(); ++point) {
    look(points.at(point, nodes_m), points.face_size_m(point));
    for (int a = 0; a < points.nodes_per_face(); ++a)
      look(nodes_m.col(points.node(points.face_of(point), a)), points.face_size_m(point));
  }
  if (deepest_m == 0.0) return;
  std::ostringstream text;
  text << "obstacle '" << obstacle.name << "' is " << deepest_m << " m inside the body at the start, at "
       << point_text(where_m) << "; must be outside, as where its motion starts";
  throw std::invalid_argument(text.str());
}

// A thing so small that no point of the skin is in it.
void refuse_swallowed(const Body& body, const Obstacle& obstacle) {
  if (std::holds_alternative<Plane>(obstacle.shape)) return;
  const auto* mesh = std::get_if<MeshShape>(&obstacle.shape);
  const Eigen::Vector3d middle_m =
      pose_at(obstacle, 0.0) * (mesh != nullptr ? mesh->solid->deepest_m() : center_m(obstacle.shape));
  if (MeshLocator(body.mesh()).locate(middle_m).distance_m > 0.0) return;
  throw std::invalid_argument("obstacle '" + obstacle.name + "': its middle, " + point_text(middle_m) +
                              ", is inside the body at the start; must be outside");
}

void refuse_inside(const Obstacle& own, const PlacedShape& one, const Obstacle& others, const PlacedShape& other) {
  if (spheres_apart_m(one, other) > 0.0) return;
  const double apart_m = soft_robot_lab::apart_m(one, other);
  if (apart_m >= -kOverlap * size_m(own.shape)) return;
  std::ostringstream text;
  text << "obstacle '" << own.name << "' is " << -apart_m << " m inside obstacle '" << others.name
       << "' at the start; must be outside";
  throw std::invalid_argument(text.str());
}

// Of each two obstacles of which one is free.
void refuse_free_inside(const std::vector<Obstacle>& obstacles) {
  const FreeObstacles free(obstacles, Eigen::Vector3d::Zero());
  const auto placed = [&](int index) -> PlacedShape {
    const Obstacle& obstacle = obstacles[static_cast<std::size_t>(index)];
    const int of_free = free.index_of(index);
    return {obstacle.shape, of_free >= 0 ? free.pose(of_free, free.at_start()) : pose_at(obstacle, 0.0)};
  };
  const auto count = static_cast<int>(obstacles.size());
  for (int one = 0; one < count; ++one) {
    for (int other = 0; other < count && free.index_of(one) >= 0; ++other) {
      if (other == one || (other < one && free.index_of(other) >= 0)) continue;
      refuse_inside(obstacles[static_cast<std::size_t>(one)], placed(one), obstacles[static_cast<std::size_t>(other)],
                    placed(other));
    }
  }
}

// The deepest node of one body in another one.
struct Depth {
  double depth_m = 0.0;
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();
};

Depth deepest(const Body& body, int of, int in) {
  const TetMesh& mesh = body.mesh();
  std::vector<Eigen::Index> skin;
  Eigen::AlignedBox3d around;
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    if (body.body_of_node(mesh.faces(0, face)) != in) continue;
    skin.push_back(face);
    for (const int node : mesh.faces.col(face)) around.extend(mesh.nodes_m.col(node));
  }
  const MeshLocator locator(mesh, in);
  Depth deepest;
  for (int node = 0; node < mesh.node_count(); ++node) {
    const Eigen::Vector3d at_m = mesh.nodes_m.col(node);
    if (body.body_of_node(node) != of || !around.contains(at_m) || locator.locate(at_m).distance_m > 0.0) continue;
    const double depth_m = nearest_on_skin(mesh, skin, at_m).distance_m;
    if (depth_m > deepest.depth_m) deepest = {depth_m, at_m};
  }
  return deepest;
}

}  // namespace

void refuse_overlap(const Body& body, int first, int second) {
  const Depth one = deepest(body, first, second), other = deepest(body, second, first);
  const bool of_first = one.depth_m > other.depth_m;
  const Depth& worst = of_first ? one : other;
  if (worst.depth_m <= kRoundingOfBodies * body.size_m()) return;
  const auto name = [&](int index) { return "'" + body.mesh().bodies[static_cast<std::size_t>(index)] + "'"; };
  std::ostringstream text;
  text << "body " << name(of_first ? first : second) << " is " << worst.depth_m << " m inside body "
       << name(of_first ? second : first) << " at the start, at " << point_text(worst.at_m) << "; must be outside";
  throw std::invalid_argument(text.str());
}

void refuse_overlap(const Body& body, const std::vector<Obstacle>& obstacles) {
  if (obstacles.empty()) return;
  const ContactPoints points(body);
  for (const Obstacle& obstacle : obstacles) {
    refuse_skin_inside(body, points, obstacle);
    refuse_swallowed(body, obstacle);
  }
  refuse_free_inside(obstacles);
}

}  // namespace soft_robot_lab
