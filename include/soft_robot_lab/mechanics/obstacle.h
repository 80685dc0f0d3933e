// SPDX-License-Identifier: BSD-3-Clause
// Rigid things that a body touches. Lengths in metres, frame: robot_base.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

namespace soft_robot_lab {

// Everything on the side that the normal points away from.
struct Plane {
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // of any length but zero
};

struct Sphere {
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
  double radius_m = 0.0;
};

// All points within the radius of a straight piece.
struct Capsule {
  Eigen::Vector3d start_m = Eigen::Vector3d::Zero(), end_m = Eigen::Vector3d::UnitZ();
  double radius_m = 0.0;
};

// With flat ends, whose edges are rounded.
struct Cylinder {
  Eigen::Vector3d start_m = Eigen::Vector3d::Zero(), end_m = Eigen::Vector3d::UnitZ();
  double radius_m = 0.0;
  double rounding_m = 0.0;  // (0, radius_m], and no more than half the length
};

// Along the axes, until it is turned, with rounded edges.
struct RoundedBox {
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero(), size_m = Eigen::Vector3d::Ones();
  double rounding_m = 0.0;  // (0, half of the least size]
};

class MeshSolid;

// What triangles bound; mesh_shape() makes it. It turns about its centroid.
struct MeshShape {
  std::shared_ptr<const MeshSolid> solid;
};

// Of a closed surface: triangles, 3 indices of vertices each, counter-clockwise from outside. Edges are rounded by
// rounding_m, >= 0; 0: by a 64th of its size, or less where it has thin walls or fine details. Throws
// std::invalid_argument, with a place, where the surface is open or faces inward, has walls thinner than two roundings,
// or is too large for so fine a rounding.
MeshShape mesh_shape(const Eigen::Matrix3Xd& vertices_m, const Eigen::Matrix3Xi& triangles, double rounding_m = 0.0);

using ObstacleShape = std::variant<Plane, Sphere, Capsule, Cylinder, RoundedBox, MeshShape>;

// Where an obstacle stands at a time: turned about its own centre, and moved.
struct ObstaclePose {
  double time_s = 0.0;
  Eigen::Vector3d translation_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d rotation_rad = Eigen::Vector3d::Zero();  // axis times angle
};

// Throws std::invalid_argument: field, value, allowed range.
void validate_motion(const std::vector<ObstaclePose>& motion);

struct Obstacle {
  std::string name;
  ObstacleShape shape;
  // In rising order of time. Between two poses it moves and turns evenly, before the first and after the last it
  // stands still. Empty: it stays where the shape says.
  std::vector<ObstaclePose> motion;
  double friction = 0.0;  // Coulomb's coefficient, of the body on it; [0, inf)

  // Above 0 the obstacle is free: from where the shape says, at time 0, gravity and contact move it. Then it has no
  // motion, and is no plane.
  double mass_kg = 0.0;
  std::optional<Eigen::Matrix3d> inertia_kg_m2 = std::nullopt;  // about its centre; none: that of a solid evenly filled
  Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero(),
                  angular_velocity_rad_s = Eigen::Vector3d::Zero();  // at time 0
  // Coulomb's coefficient of a free obstacle on others, by their names; of those that are not listed, 0.
  std::map<std::string, double> friction_on = {};

  bool is_free() const { return mass_kg > 0.0; }
  void validate() const;  // throws std::invalid_argument: field, value, allowed range
};

inline constexpr const char* kSkin = "skin";  // a body's own, where it touches itself; no obstacle's name

// What the skin and an obstacle do to one another, or skin and skin; or two obstacles, which touch at points without an
// area. Areas are of the present shape. Of several bodies skin that meets skin has their names, first that of `on`.
struct ContactReading {
  std::string surface;                                    // the obstacle's name, kSkin, or that of a body
  std::string on = kSkin;                                 // or the name of a free obstacle that it touches
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();      // of the surface on that; zero of a body's skin on itself
  double normal_force_n = 0.0;                            // sum of the pressures' forces
  double area_m2 = 0.0;                                   // with pressure
  double sticking_area_m2 = 0.0, slipping_area_m2 = 0.0;  // of it, where there is friction
  double largest_penetration_m = 0.0;
  // Of pressure, and the mean normal, out of the surface; zero where there is none, and of a body on itself.
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
  double largest_pressure_pa = 0.0;  // force per rest area
};

// Where free obstacles are, one column each, in their order among all.
struct FreePoses {
  Eigen::Matrix3Xd centers_m;
  Eigen::Matrix4Xd turns;  // from how the shape is stated: quaternions x, y, z, w

  bool operator==(const FreePoses& other) const {
    return centers_m.cols() == other.centers_m.cols() && centers_m == other.centers_m && turns == other.turns;
  }
};

struct FreeVelocities {
  Eigen::Matrix3Xd linear_m_s, angular_rad_s;

  bool operator==(const FreeVelocities& other) const {
    return linear_m_s.cols() == other.linear_m_s.cols() && linear_m_s == other.linear_m_s &&
           angular_rad_s == other.angular_rad_s;
  }
};

// What contact adds to the state of a simulation. Plain numbers; all empty without contact.
struct ContactState {
  double time_s = 0.0;           // of the obstacles' motion
  Eigen::VectorXd pressures_pa;  // per obstacle, and last of skin on skin; per contact point
  // Per obstacle with friction, per contact point, in the frame of the obstacle's shape: where the skin sticks, or
  // where it was when it did not touch. With friction of skin on skin, also per point of it: the coordinates on the
  // mesh's face that it meets, and as the third number which face that is; -1: it meets none.
  Eigen::Matrix3Xd anchors_m;

  FreePoses free;
  // Per place where a free obstacle may touch another one (RigidContact): force along the normal, and how far
  // friction's tie stood off when the step before ended, at these poses and at this time.
  Eigen::VectorXd rigid_forces_n;
  Eigen::Matrix3Xd rigid_ties_m;
  FreePoses free_before;
  double before_s = 0.0;

  bool operator==(const ContactState& other) const {
    return time_s == other.time_s && pressures_pa.size() == other.pressures_pa.size() &&
           anchors_m.cols() == other.anchors_m.cols() && pressures_pa == other.pressures_pa &&
           anchors_m == other.anchors_m && free == other.free && free_before == other.free_before &&
           before_s == other.before_s && rigid_forces_n.size() == other.rigid_forces_n.size() &&
           rigid_forces_n == other.rigid_forces_n && rigid_ties_m == other.rigid_ties_m;
  }
};

}  // namespace soft_robot_lab
