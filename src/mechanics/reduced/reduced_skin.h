// SPDX-License-Identifier: BSD-3-Clause
// Skin that meets skin in a reduced model, by the contact points, gaps and law of the full one (SkinContact), between
// the faces that met in its training and their neighbours. What meets elsewhere is not seen: audits see it.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "mechanics/contact/skin_contact.h"
#include "soft_robot_lab/mechanics/constraint.h"

namespace soft_robot_lab {

class ReducedSkin {
 public:
  ReducedSkin() = default;  // none
  // No friction; `modes`: of ReducedBasis. `pairs` as with_neighbours() has them.
  ReducedSkin(const Body& body, const Eigen::MatrixXd& modes, const std::vector<FacePair>& pairs);

  // A point that touches as a constraint C = -gap, whose multiplier is its push [N].
  struct Touch {
    Eigen::Index place;         // among places()
    ContactTouch found;         // by the full model
    Eigen::Matrix3Xd relative;  // d (point less the place that it meets) / d q
    Eigen::VectorXd gradient;   // d C / d q
    ConstraintLaw law;
  };
  // All that touch or push; `pushes_n`: of all places. It keeps what it finds nearby, so an object serves one thread.
  std::vector<Touch> at(const Eigen::VectorXd& q, const Eigen::VectorXd& pushes_n);

  // Of the pushes where these touches were found, as they turn with the skin.
  Eigen::MatrixXd hessian(const std::vector<Touch>& touches) const;

  const std::vector<FacePair>& pairs() const { return pairs_; }
  Eigen::Index places() const { return static_cast<Eigen::Index>(points_.size()); }
  // Into ContactState::pressures_pa of a full model with the same skin; nothing where that does not touch itself.
  void add_pressures(const Eigen::VectorXd& pushes_n, Eigen::VectorXd& pressures_pa) const;

 private:
  struct Face {
    int face;            // of the points
    Eigen::Index first;  // place of its first point
  };
  auto motion_of(int node) const { return modes_.middleRows<3>(row_of_[static_cast<std::size_t>(node)]); }
  Touch touch_of(Eigen::Index place, const ContactTouch& found) const;

  std::vector<FacePair> pairs_;
  std::vector<Face> faces_;
  std::vector<int> points_;  // of each place
  std::vector<int> nodes_;   // of all these faces
  std::vector<int> row_of_;  // of each node of the body, in modes_; -1: not among nodes_
  Eigen::VectorXd rest_m_;   // 3*index + axis, of nodes_
  Eigen::MatrixXd modes_;    // the same x modes
  SkinContact skin_;
  Eigen::Matrix3Xd positions_m_;  // of all nodes; of others as at rest
};

// All pairs of two faces and of those across their edges.
std::vector<FacePair> with_neighbours(const std::vector<FacePair>& pairs, const Body& body);

}  // namespace soft_robot_lab
