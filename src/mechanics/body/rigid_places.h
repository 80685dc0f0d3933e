// SPDX-License-Identifier: BSD-3-Clause
// Where two rigid shapes may touch: places of one shape against the whole of the other, and edges of both that cross.
// Every shape is a core that its surface rounds off by a radius: a point, an axis, a flat disc of a cylinder, a box.
//   ball on shape   a sphere, an end of a capsule, a corner of a box or mesh, one of 24 points of a cylinder's edge
//   rim on shape    the two points of a cylinder's edge that are nearest: it rolls on a circle, not on a polygon
//   line on line    an edge of a box or of a mesh, or the axis of a capsule or a cylinder, that crosses another one
//   line on mesh    the two points of such a line, or of an edge of another mesh, that are nearest to a mesh, and 23
//                   points along it, fewer of short ones
//   point on mesh   of two meshes also places in the faces of either, beside its corners
// The least gap of all is how far apart the shapes are, where they do not overlap by more than their roundings: every
// pair of sphere, capsule, cylinder, box and mesh, and each of them on a plane. Where meshes have many edges, which
// cross others, each is rounded for the other, so they meet up to half a step of the grid late.
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "soft_robot_lab/mechanics/obstacle.h"

namespace soft_robot_lab {

// Of the shape as stated.
struct RoundedPoint {
  Eigen::Vector3d position_m;
  double radius_m;
};

struct RoundedLine {
  Eigen::Vector3d from_m, to_m;
  double radius_m;
  std::vector<Eigen::Vector3d> faces;  // normals of the two faces that meet in it; none of an axis
  bool flat_ends = false;              // an axis of a cylinder
};

struct RoundedRim {
  Eigen::Vector3d middle_m, outward;  // of the end that it bounds
  double radius_m, rounding_m;        // of the circle, about it
};

struct BallOnShape {
  RoundedPoint ball;
};
struct RimOnShape {
  RoundedRim rim;
  int valley;  // 0: where it is nearest, 1: the next place that is nearer than all beside it
};
struct LineOnMesh {
  RoundedLine line;
  int parts;   // in which it is looked at
  int valley;  // as of a rim
};
struct LineOnLine {
  RoundedLine own, other;
  double deepest_m;  // farther through one another the lines are on far sides of their shapes
};

struct RigidPlace {
  bool of_other;  // the ball or rim is the other shape's
  std::variant<BallOnShape, RimOnShape, LineOnMesh, LineOnLine> kind;
};

// All of one shape and another, in an order that never changes.
std::vector<RigidPlace> rigid_places(const ObstacleShape& one, const ObstacleShape& other);

struct RigidMeeting {
  double gap_m = 0.0;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();      // of the other, towards the one
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  // where they touch
  Eigen::Matrix3d bend = Eigen::Matrix3d::Zero();        // second derivative of the gap, by how the one moves
};

// Where the two stand so; none where edges do not cross.
std::optional<RigidMeeting> meet(const RigidPlace& place, const ObstacleShape& one, const Eigen::Isometry3d& one_pose,
                                 const ObstacleShape& other, const Eigen::Isometry3d& other_pose);

struct PlacedShape {
  const ObstacleShape& shape;
  Eigen::Isometry3d pose;
};

double bounding_radius_m(const ObstacleShape& shape);  // about its centre; infinite of a plane

// How far apart two shapes are, of which the first is no plane: no more than that, by spheres around them; and exactly
// so, to a millionth of their sizes. Negative where they overlap, then half-way between both surfaces' depths there.
double spheres_apart_m(const PlacedShape& one, const PlacedShape& other);
double apart_m(const PlacedShape& one, const PlacedShape& other);

}  // namespace soft_robot_lab
