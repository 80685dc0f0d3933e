// SPDX-License-Identifier: BSD-3-Clause
// Which faces of the skin may meet which, by their shape at rest.
#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>

#include "mechanics/body/contact_points.h"
#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {

// Which pair of Body::touching_bodies two bodies are.
class TouchingPairs {
 public:
  TouchingPairs() = default;  // none
  explicit TouchingPairs(const Body& body);
  int operator()(int body, int other) const { return of_bodies_(body, other); }  // -1: they do not touch

 private:
  Eigen::MatrixXi of_bodies_;
};

// Faces whose boxes, each wider by so much, overlap; each pair once.
std::vector<std::pair<int, int>> overlapping_faces(const Eigen::MatrixXi& faces, const Eigen::Matrix3Xd& positions_m,
                                                   double wider_m);

// Faces are the mesh's, but for those of the points where it says so.
class SkinAtRest {
 public:
  static constexpr double kDeepest = 0.5;  // of a face's size: deeper is the other side of a wall, as is beyond a wall
  static constexpr double kAgainst = 0.2;  // cosine: skin that meets skin faces it at least so much
  // Of a face's size: behind it by no more a point meets it, whatever nearer skin the point is in front of.
  static constexpr double kHeldOver = 1e-3;

  SkinAtRest() = default;  // none
  SkinAtRest(const Body& body, const ContactPoints& points);

  const Eigen::MatrixXi& faces() const { return faces_; }      // nodes x faces, of the whole mesh
  const std::vector<int>& nodes() const { return nodes_; }     // of these
  const Eigen::VectorXd& sizes_m() const { return sizes_m_; }  // edge of half a square of each face's area
  double size_m(int face) const { return sizes_m_[face]; }
  double largest_size_m() const { return largest_size_m_; }
  // How deep behind it skin still counts as inside: half its size, or all of the wall behind it.
  const Eigen::VectorXd& deepest_m() const { return deepest_m_; }
  double deepest_m(int face) const { return deepest_m_[face]; }

  // Of each face of the points, the mesh's.
  const std::vector<int>& same() const { return same_; }
  int same(int face) const { return same_[static_cast<std::size_t>(face)]; }
  int body_of(int face) const { return body_[static_cast<std::size_t>(face)]; }
  // Of a face of the points and one of the mesh the pair of bodies; -1: these do not touch.
  int pair_of(int face, int other) const { return touching_(body_of(same(face)), body_of(other)); }
  // Whether points of the one may meet the other at all.
  bool counts(int face, int other) const;
  bool counts_kept(int face, int other);  // the same; what was found is kept
  void keep_nothing() { kept_.clear(); }

 private:
  bool overlap(int mine, int other) const;  // any of mine is behind the other

  Eigen::MatrixXi faces_;
  std::vector<int> nodes_;
  Eigen::Matrix3Xd nodes_m_, middles_m_, normals_;
  Eigen::VectorXd sizes_m_, deepest_m_;
  double largest_size_m_ = 0.0;
  std::vector<int> same_, body_;
  TouchingPairs touching_;
  std::vector<signed char> kept_;  // of both, where it is known; empty where that would be too many
};

}  // namespace soft_robot_lab
