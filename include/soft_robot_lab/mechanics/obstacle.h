// SPDX-License-Identifier: BSD-3-Clause
// Rigid things that a body touches. Lengths in metres, frame: robot_base.
#pragma once

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

using ObstacleShape = std::variant<Plane, Sphere, Capsule, Cylinder, RoundedBox>;

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

  void validate() const;  // throws std::invalid_argument: field, value, allowed range
};

inline constexpr const char* kSkin = "skin";  // a body's own, where it touches itself; no obstacle's name

// What a body and an obstacle, or its own skin, do to one another. Areas are of the present shape.
struct ContactReading {
  std::string surface;                                    // the obstacle's name, or kSkin
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();      // of the obstacle on the body; skin pushes both ways: zero
  double normal_force_n = 0.0;                            // sum of the pressures' forces
  double area_m2 = 0.0;                                   // with pressure
  double sticking_area_m2 = 0.0, slipping_area_m2 = 0.0;  // of it, where there is friction
  double largest_penetration_m = 0.0;
  double largest_pressure_pa = 0.0;  // force per rest area
};

// What contact adds to the state of a simulation. Plain numbers; all empty without contact.
struct ContactState {
  double time_s = 0.0;           // of the obstacles' motion
  Eigen::VectorXd pressures_pa;  // per obstacle, and last the body's own skin; per contact point
  // Per obstacle with friction, per contact point, in the frame of the obstacle's shape: where the skin sticks, or
  // where it was when it did not touch.
  Eigen::Matrix3Xd anchors_m;

  bool operator==(const ContactState& other) const {
    return time_s == other.time_s && pressures_pa.size() == other.pressures_pa.size() &&
           anchors_m.cols() == other.anchors_m.cols() && pressures_pa == other.pressures_pa &&
           anchors_m == other.anchors_m;
  }
};

}  // namespace soft_robot_lab
