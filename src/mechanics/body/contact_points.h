// SPDX-License-Identifier: BSD-3-Clause
// The points of a body's skin at which contact acts. The corner functions of a quadratic triangle integrate to zero, so
// forces at nodes would miss a uniform pressure; the points inside a face integrate its functions exactly.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {

// Young's modulus of the element behind each face of the mesh [Pa].
Eigen::VectorXd moduli_of_faces_pa(const Body& body);

enum class PointSpread {
  // For obstacles: three points inside each face, enough for what is smooth. Of a face with an edge that is sharp at
  // rest also seven with its corners and sides, for what is flat: a body stands on its whole foot.
  sparse,
  dense,  // twelve, and guards along the edges that stand out sharply at rest: for other skin, which has edges
};

class ContactPoints {
 public:
  ContactPoints() = default;  // none
  // Of all faces that can move.
  explicit ContactPoints(const Body& body, PointSpread spread = PointSpread::sparse);

  int count() const { return static_cast<int>(weights_m2_.size()); }
  int face_count() const { return static_cast<int>(faces_.cols()); }
  int nodes_per_face() const { return static_cast<int>(faces_.rows()); }
  int face_of(int point) const { return face_of_[static_cast<std::size_t>(point)]; }
  int first_point(int face) const { return first_[static_cast<std::size_t>(face)]; }  // one more: past the last

  int node(int face, int corner) const { return faces_(corner, face); }
  const Eigen::MatrixXi& faces() const { return faces_; }             // nodes x faces
  const std::vector<int>& mesh_faces() const { return mesh_faces_; }  // which of the mesh's they are
  // Of the face's nodes at the point.
  auto shape(int point) const { return places_.shape.col(place_of(point)); }
  // Share of the rest area; a guard has that of a point inside, beside them.
  double weight_m2(int point) const { return weights_m2_[point]; }
  bool guards(int point) const { return beside(point) >= 0; }
  int beside(int point) const { return beside_[static_cast<std::size_t>(point)]; }  // the mesh's other face at a guard
  // Of the sparse spread, for an obstacle that is flat or not.
  bool serves(int point, bool flat) const;
  // Whether the point's face looks along a direction as much as any that meets it in a sharp edge or corner, less a
  // margin (cosine): of the faces that have a point there, which one counts.
  bool looks_most(int point, const Eigen::Vector3d& way, double margin, const Eigen::Matrix3Xd& positions_m) const;
  bool is_round(int point) const { return round_[static_cast<std::size_t>(face_of(point))]; }  // its face, with others
  double face_size_m(int point) const { return sizes_m_[face_of(point)]; }  // edge of half a square of its area
  double least_face_size_m() const { return sizes_m_.minCoeff(); }
  double largest_face_size_m() const { return sizes_m_.maxCoeff(); }

  Eigen::Vector3d at(int point, const Eigen::Matrix3Xd& columns) const;          // the nodes' columns, interpolated
  double present_area_m2(int point, const Eigen::Matrix3Xd& positions_m) const;  // that it stands for; guards: little
  Eigen::Vector3d outward_m2(int point, const Eigen::Matrix3Xd& positions_m) const;  // normal, as long as that

 private:
  void set_beyond(const TetMesh& mesh);
  bool stands(int face) const;  // has points for what is flat
  int place_of(int point) const { return place_of_[static_cast<std::size_t>(point)]; }

  // In a face, of all rules.
  struct Places {
    Eigen::MatrixXd shape;             // nodes x places
    Eigen::MatrixXd along_r, along_s;  // its derivatives
    Eigen::VectorXd shares;            // of twice the area
  };

  Eigen::MatrixXi faces_;
  std::vector<int> mesh_faces_;
  std::vector<int> first_, face_of_, place_of_, beside_;
  Places places_;
  Eigen::VectorXd weights_m2_, sizes_m_;
  std::vector<std::vector<int>> beyond_;  // per face the mesh's that meet it sharply; of the sparse spread
  std::vector<bool> round_;               // per face, likewise
  Eigen::MatrixXi all_faces_;             // the mesh's; likewise
  int points_inside_ = 0;                 // a face, before its guards or those of its foot
};

}  // namespace soft_robot_lab
