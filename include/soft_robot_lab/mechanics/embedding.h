// SPDX-License-Identifier: BSD-3-Clause
// Points carried by the mesh: where a rest position lies, and how it follows the nodes.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "tet_mesh.h"

namespace soft_robot_lab {

// A linear combination of node positions; the weights sum to one. A row of the interpolation matrix W.
struct EmbeddedPoint {
  std::vector<int> nodes;
  std::vector<double> weights;
  Eigen::Vector3d offset_m = Eigen::Vector3d::Zero();  // of a point that belongs to no silicone, from a held node

  Eigen::Vector3d at(const Eigen::Matrix3Xd& positions_m) const;
};

// The mean of several points, with equal nodes merged.
EmbeddedPoint average(const std::vector<EmbeddedPoint>& points);

struct Location {
  int tet = -1;
  Eigen::Vector3d local = Eigen::Vector3d::Zero();      // reference coordinates: weights of corners 1, 2, 3
  Eigen::Vector3d nearest_m = Eigen::Vector3d::Zero();  // the point itself, or the nearest point of the body
  double distance_m = 0.0;                              // 0 inside
};

// Finds rest positions in a mesh, or in one of its bodies. Keeps a reference to the mesh.
class MeshLocator {
 public:
  explicit MeshLocator(const TetMesh& mesh, std::optional<int> only_body = std::nullopt);

  // The element that holds the point, or the nearest point of the body when it lies outside.
  Location locate(const Eigen::Vector3d& point_m) const;

  EmbeddedPoint embed(const Location& location) const;

  // The weights of a rest point; outside the body those of its nearest point.
  EmbeddedPoint embed(const Eigen::Vector3d& point_m) const { return embed(locate(point_m)); }

  // The mean over a disc (centre, normal, radius), or a cube of the given edge: sample points outside the body are left
  // out.
  EmbeddedPoint embed_disc(const Eigen::Vector3d& center_m, const Eigen::Vector3d& normal, double radius_m) const;
  EmbeddedPoint embed_box(const Eigen::Vector3d& center_m, double edge_m) const;

 private:
  const TetMesh& mesh_;
  Eigen::Matrix3Xd box_min_m_, box_max_m_;  // per element; empty of other bodies
  std::vector<Eigen::Index> faces_;
};

}  // namespace soft_robot_lab
