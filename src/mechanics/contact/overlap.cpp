// SPDX-License-Identifier: BSD-3-Clause
#include "overlap.h"

#include <sstream>
#include <stdexcept>

#include "contact_points.h"
#include "gap.h"
#include "rigid_contact.h"
#include "mechanics/mesh/point_text.h"
#include "soft_robot_lab/mechanics/embedding.h"

namespace soft_robot_lab {
namespace {

constexpr double kRounding = 0.01;  // of a face's size

// The skin, at its contact points and nodes.
void refuse_skin_inside(const Body& body, const ContactPoints& points, const Obstacle& obstacle) {
  const Eigen::Isometry3d pose = pose_at(obstacle, 0.0);
  double deepest_m = 0.0;
  Eigen::Vector3d where_m = Eigen::Vector3d::Zero();
  const auto look = [&](const Eigen::Vector3d& at, double face_size_m) {
    const double gap_m = gap_to(obstacle.shape, pose, at).gap_m;
    if (gap_m >= -kRounding * face_size_m || gap_m >= deepest_m) return;
    deepest_m = gap_m;
    where_m = at;
  };
  const Eigen::Matrix3Xd& nodes_m = body.mesh().nodes_m;
  for (int point = 0; point < points.count(); ++point) {
    look(points.at(point, nodes_m), points.face_size_m(point));
    for (int a = 0; a < points.nodes_per_face(); ++a)
      look(nodes_m.col(points.node(ContactPoints::face_of(point), a)), points.face_size_m(point));
  }
  if (deepest_m == 0.0) return;
  std::ostringstream text;
  text << "obstacle '" << obstacle.name << "' is " << -deepest_m << " m inside the body at the start, at "
       << point_text(where_m) << "; must be outside, as where its motion starts";
  throw std::invalid_argument(text.str());
}

// A thing so small that no point of the skin is in it.
void refuse_swallowed(const Body& body, const Obstacle& obstacle) {
  if (std::holds_alternative<Plane>(obstacle.shape)) return;
  const Eigen::Vector3d middle_m = pose_at(obstacle, 0.0) * center_m(obstacle.shape);
  if (MeshLocator(body.mesh()).locate(middle_m).distance_m > 0.0) return;
  throw std::invalid_argument("obstacle '" + obstacle.name + "': its middle, " + point_text(middle_m) +
                              ", is inside the body at the start; must be outside");
}

}  // namespace

void refuse_overlap(const Body& body, const std::vector<Obstacle>& obstacles) {
  if (obstacles.empty()) return;
  const ContactPoints points(body);
  for (const Obstacle& obstacle : obstacles) {
    refuse_skin_inside(body, points, obstacle);
    refuse_swallowed(body, obstacle);
  }
  const FreeObstacles free(obstacles, Eigen::Vector3d::Zero());
  RigidContact(obstacles, free, body.material().youngs_modulus_pa).refuse_overlap();
}

}  // namespace soft_robot_lab
