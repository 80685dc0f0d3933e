// SPDX-License-Identifier: BSD-3-Clause
// Where points of a body's skin meet other skin of the same body, in its present shape. Bullet's tree of boxes finds
// the faces that are near; the closest place on a face and the gap to it are ours, in double precision.
//
// No pairs are faces that share a node, and faces that lie behind one another at rest, nearer than a few faces: the two
// sides of a thin wall.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "contact_points.h"
#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {

// A place on the face that a point meets, and what the derivatives of the gap need there.
struct SkinPlace {
  template <int rows, int columns>
  using Table = Eigen::Matrix<double, rows, columns, Eigen::DontAlign>;

  int face = -1;                                 // of the mesh; -1: none
  Table<6, 1> shape = Table<6, 1>::Zero();       // functions of the face's nodes; the last are zero for 3 nodes
  Table<6, 2> slopes = Table<6, 2>::Zero();      // their derivatives along the face's two coordinates
  Table<3, 2> dual_per_m = Table<3, 2>::Zero();  // dual tangents: d coordinate / d position
};

struct SkinGap {
  double gap_m = 0.0;  // negative: the point is inside
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  Eigen::Matrix3d curvature_per_m = Eigen::Matrix3d::Zero();  // of the face, n . d2y
  SkinPlace at;
};

// A point's face, in the order of ContactPoints, and the mesh's face that it may meet.
using FacePair = std::pair<int, int>;

class SkinPairs {
 public:
  SkinPairs() = default;  // none
  SkinPairs(const Body& body, const ContactPoints& points);

  // Must come before any_near and meet, at the same positions. What it finds serves until a node has moved far; so an
  // object serves one thread.
  void prepare(const Eigen::Matrix3Xd& positions_m);

  bool any_near(int face) const { return !near_[static_cast<std::size_t>(face)].empty(); }
  // The closest skin that a point of this face meets at this place, or none within the depth that counts.
  std::optional<SkinGap> meet(int face, const Eigen::Vector3d& point_m, const Eigen::Vector3d& outward,
                              const Eigen::Matrix3Xd& positions_m) const;

  // Pairs that nearly touch, sorted: those that a step may bring together. Of those near where prepare() was called.
  std::vector<FacePair> likely(const Eigen::Matrix3Xd& positions_m) const;

  int node(int face, int corner) const { return faces_(corner, face); }  // of the mesh's face
  std::vector<int> nodes(const FacePair& pair) const;                    // of both faces

 private:
  bool counts(int face, int other) const;
  std::optional<SkinGap> gap_to(int other, const Eigen::Vector3d& point_m, const Eigen::Vector3d& outward,
                                const Eigen::Matrix3Xd& positions_m) const;
  void find_near(const Eigen::Matrix3Xd& positions_m);

  Eigen::MatrixXi faces_;  // nodes x faces, of the whole mesh
  Eigen::Matrix3Xd rest_middles_m_, rest_normals_;
  Eigen::VectorXd sizes_m_;
  std::vector<int> same_;  // of each face of the points, the mesh's
  double largest_size_m_ = 0.0, margin_m_ = 0.0;

  Eigen::Matrix3Xd near_at_m_;  // where near_ was found
  std::vector<std::vector<int>> near_;
  Eigen::Matrix3Xd low_m_, high_m_;  // corners of a box around each face, at the present positions
};

}  // namespace soft_robot_lab
