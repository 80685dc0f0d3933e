// SPDX-License-Identifier: BSD-3-Clause
// Faces of skin as they lie at present, each looked at once it is asked for: bounds by which others that cannot meet it
// are left early.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "closest_place.h"

namespace soft_robot_lab {

// Positions of a face's nodes.
FaceNodes nodes_of(const Eigen::MatrixXi& faces, int face, const Eigen::Matrix3Xd& positions_m);

struct PresentFace {
  Eigen::Vector3d normal;  // of its corners,
  double lowest_m, top_m;  // and how far along this it reaches
  // Corners of a box around it, and around it with what lies behind it to the depth that counts.
  Eigen::Vector3d low_m, high_m, deep_low_m, deep_high_m;
  Eigen::Matrix<double, 3, 6> around_m;  // points that it lies between; of 3 nodes each twice
  // What few faces are asked for; -1 or false: not known yet.
  double turns_per_m = -1.0, tilt = -1.0;
  bool knows_sides = false;
  Eigen::Matrix3d sideways;    // rows, in its plane, square to its sides,
  Eigen::Vector3d farthest_m;  // and how far along these it reaches
};

// How far one face's box is from the other's with what lies behind it, along an axis; negative: they meet.
double apart_m(const PresentFace& mine, const PresentFace& theirs);
// How high one face lies over the top of the other, at least.
double lowest_above_m(const PresentFace& mine, const PresentFace& theirs);

class PresentFaces {
 public:
  PresentFaces() = default;  // none
  // Of each face, how deep behind it still counts, and how far beyond its edges that goes.
  PresentFaces(Eigen::MatrixXi faces, Eigen::VectorXd deepest_m, Eigen::VectorXd over_edge_m);

  // False where they lie there already.
  bool move_to(const Eigen::Matrix3Xd& positions_m);
  const Eigen::Matrix3Xd& positions_m() const { return positions_m_; }

  const PresentFace& operator[](int face) const {
    if (!known_[static_cast<std::size_t>(face)]) look_at(face);
    return all_[static_cast<std::size_t>(face)];
  }
  const PresentFace& with_sides(int face) const;
  double turns_per_m(int face) const;  // how much the normal may turn, as a change of it, as nodes move
  double tilt(int face) const;         // how far normals of the face tilt at most, as a tangent

 private:
  void look_at(int face) const;

  Eigen::MatrixXi faces_;  // nodes x faces
  Eigen::VectorXd deepest_m_, over_edge_m_;
  Eigen::Matrix3Xd positions_m_;
  mutable std::vector<PresentFace> all_;  // where known at positions_m_
  mutable std::vector<char> known_;
};

}  // namespace soft_robot_lab
