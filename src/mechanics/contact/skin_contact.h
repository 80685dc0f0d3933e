// SPDX-License-Identifier: BSD-3-Clause
// Skin that meets other skin, of the same body or another, as a part of ContactTerm. A point of the skin pushes the
// closest place y of the face that it meets; n is the face's normal there, g = n . (x - y), and with the tangents t_a,
// their duals t^a and the curvature k (Wriggers 2006, 6.4, at g = 0)
//   d2g = - (n . dy,a) t^a . (dx - dy) - its transpose - k (dx - dy) (dx - dy)
// Both sides push, each by its own points.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "mechanics/body/contact_points.h"
#include "contact_touch.h"
#include "normal_law.h"
#include "skin_pairs.h"
#include "soft_robot_lab/mechanics/body.h"
#include "soft_robot_lab/mechanics/obstacle.h"

namespace soft_robot_lab {

class SkinContact {
 public:
  SkinContact() = default;  // none
  // Its points have the pairs from `first_pair` on, its anchors the columns of
  // ContactState::anchors_m from `first_anchor` on.
  SkinContact(const Body& body, int first_pair, int first_anchor);

  const ContactPoints& points() const { return points_; }
  const SkinPairs& pairs() const { return pairs_; }
  int point_of(const ContactTouch& touch) const { return touch.pair - first_pair_; }
  double slack_m(int point) const;     // how deep a point may be before it counts: guards
  bool rubs() const { return rubs_; }  // whether any two bodies do
  int pair_count() const { return static_cast<int>(touching_.size()); }
  int pair_of(const ContactTouch& touch) const {  // index into Body::touching_bodies, of one that meets skin
    return pairs_.pair_of(points_.face_of(point_of(touch)), touch.met.face);
  }
  double friction(const ContactTouch& touch) const {
    return touching_[static_cast<std::size_t>(pair_of(touch))].friction;
  }
  // 1 where the point that is pushed is of the pair's first body, -1 of the second, 0 where both are one.
  int side_of(const ContactTouch& touch) const;
  // Of the softer of the two faces; of a point that meets none, of its own.
  double youngs_modulus_pa(const ContactTouch& touch) const;
  NormalLaw law(const ContactTouch& touch) const {
    return NormalLaw::of_skin(points_.face_size_m(point_of(touch)), youngs_modulus_pa(touch));
  }
  FacePair faces_of(const ContactTouch& touch) const { return {points_.face_of(point_of(touch)), touch.met.face}; }

  void find_touches(const Eigen::Matrix3Xd& positions_m, const ContactState& state,
                    std::vector<ContactTouch>& touches) const;

  // Points that press go on meeting the faces that they meet here, also a little beyond their edges, until these are
  // let go.
  void keep_faces(const std::vector<ContactTouch>& touches);
  bool keeps_faces() const { return !kept_.empty(); }
  void let_faces_go();

  // Looks at these pairs alone (SkinPairs).
  void restrict_to(const std::vector<FacePair>& pairs) { pairs_.restrict_to(pairs); }
  void prepare(const Eigen::Matrix3Xd& positions_m) const { pairs_.prepare(positions_m); }
  // The same of one point, by its pressure, without friction. prepare() must come before, at the same positions.
  bool find_touch(int point, double pressure_pa, const Eigen::Matrix3Xd& positions_m, ContactTouch& touch) const;

  // Of one that is closed, over the nodes of both faces. Where pressure and gap do not fit at all, as after a step that
  // led too deep, what turns with the skin is left out: such pressures would make the matrix indefinite.
  Eigen::MatrixXd hessian(const ContactTouch& touch, bool convex, bool soft) const;
  void add_back(const ContactTouch& touch, const Eigen::Vector3d& force_n, Eigen::Matrix3Xd& forces_n) const;
  // Which closed ones meet an edge that they are beyond; what follows a motion (skin_motion.h) asks for that.
  void find_edges(const Eigen::Matrix3Xd& positions_m, std::vector<ContactTouch>& touches) const;

  // How much of this step may be taken at first: where skin is carried so deep into skin that it might not be seen any
  // more, or come out on the other side, only a part of it.
  double first_length(const Eigen::Matrix3Xd& positions_m, const Eigen::Matrix3Xd& motion_m) const;

  // Whether skin goes through skin, or far into it, where all nodes go straight from one place to another.
  bool passes(const Eigen::Matrix3Xd& from_m, const Eigen::Matrix3Xd& to_m) const;

  // Lets anchors follow what slipped, and what does not touch.
  void commit(const Eigen::Matrix3Xd& positions_m, ContactState& state) const;

 private:
  // A direction that points out of the skin: at a guard between both faces of its edge.
  Eigen::Vector3d outward(int point, const Eigen::Matrix3Xd& positions_m) const;
  bool keeps_any(int first, int end) const;  // of these points
  void search(const Eigen::Matrix3Xd& positions_m, const ContactState& state, std::vector<ContactTouch>& touches) const;
  void add_touch(int point, const Eigen::Matrix3Xd& positions_m, const ContactState& state,
                 std::vector<ContactTouch>& touches) const;
  // What a point meets where it may be inside the body, or wherever it is, if it was `pressed`.
  std::optional<SkinGap> met_by(int point, bool pressed, const Eigen::Matrix3Xd& positions_m) const;
  // Of a point that has an anchor on some skin.
  void add_friction(const Eigen::Matrix3Xd& positions_m, const ContactState& state, ContactTouch& touch) const;
  Eigen::Vector3d at_anchor(const Eigen::Vector3d& anchor, const Eigen::Matrix3Xd& columns) const {
    return pairs_.at(static_cast<int>(anchor.z()), anchor.x(), anchor.y(), columns);
  }
  Eigen::Vector3d new_anchor(int point, const ContactTouch* slipped, const Eigen::Matrix3Xd& positions_m) const;
  double deepest(const Eigen::Matrix3Xd& positions_m) const;  // over the size of the face that it is in

  // What was searched for last, as a matrix or a reading is mostly asked for where the residual was.
  struct Found {
    Eigen::Matrix3Xd positions_m;
    Eigen::VectorXd pressures_pa;
    Eigen::Matrix3Xd anchors_m;
    std::vector<ContactTouch> touches;

    bool at(const Eigen::Matrix3Xd& positions, const Eigen::Ref<const Eigen::VectorXd>& pressures,
            const Eigen::Ref<const Eigen::Matrix3Xd>& anchors) const {
      return positions_m.cols() == positions.cols() && anchors_m.cols() == anchors.cols() && positions_m == positions &&
             pressures_pa == pressures && anchors_m == anchors;
    }
  };

  ContactPoints points_;
  mutable SkinPairs pairs_;
  mutable Found found_;
  std::vector<int> kept_;  // of each point the face that it keeps, -1: none; empty where none does
  std::vector<TouchingBodies> touching_;
  bool rubs_ = false;
  Eigen::VectorXd moduli_pa_;  // of the mesh's faces
  int first_pair_ = 0, first_anchor_ = 0;
};

// Of the point and the place that it meets, by what the nodes' columns say of both.
Eigen::Vector3d relative_m(const SkinContact& skin, const ContactTouch& touch, const Eigen::Matrix3Xd& columns);
bool far_from_law(const SkinContact& skin, const ContactTouch& touch);
// Of its Hessian, per push, what comes of the normal that turns: by how columns turn it and move the place, in
// coordinates.
Eigen::MatrixXd hessian_of_turn(const ContactTouch& touch, const Eigen::MatrixXd& turn, const Eigen::MatrixXd& local);

}  // namespace soft_robot_lab
