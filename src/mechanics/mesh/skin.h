// SPDX-License-Identifier: BSD-3-Clause
// The skin of a mesh at rest: what is nearest to a point, and where a line passes through.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/mechanics/tet_mesh.h"

namespace soft_robot_lab {

struct SkinPoint {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  double distance_m = 0.0;  // infinite where the mesh has no faces
};

// A curved face is taken as four flat triangles.
SkinPoint nearest_on_skin(const TetMesh& mesh, const Eigen::Vector3d& point_m);
// Of these faces only.
SkinPoint nearest_on_skin(const TetMesh& mesh, const std::vector<Eigen::Index>& faces, const Eigen::Vector3d& point_m);

// A place of the skin that moves with the nodes.
struct GripPlace {
  Eigen::Vector3d rest_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d rest_normal = Eigen::Vector3d::Zero();  // outward
  double distance_m = 0.0;                                // from the point to it; infinite where the mesh has no faces
};

// The place that is nearest to a point where the nodes are now, 3 x nodes.
GripPlace grip_on_skin(const TetMesh& mesh, const Eigen::Matrix3Xd& positions_m, const Eigen::Vector3d& point_m);

struct SkinCrossing {
  double share;            // of the line
  Eigen::Vector3d normal;  // of the skin there; a unit vector, outward
};

// Where the straight line from one point to another meets the quadratic faces, in rising shares. Once for an edge that
// faces share; not for faces along which it runs.
std::vector<SkinCrossing> skin_crossings(const TetMesh& mesh, const Eigen::Vector3d& from_m,
                                         const Eigen::Vector3d& to_m);

}  // namespace soft_robot_lab
