// SPDX-License-Identifier: BSD-3-Clause
// All further energies of the nodes: of the body's fibres, and those that actuators hand out.
#pragma once

#include <memory>
#include <vector>

#include "mechanics/elements/clique_adder.h"
#include "mechanics/elements/fibre_term.h"
#include "mechanics/linear_algebra/block_matrix.h"
#include "mechanics/state/driven_constraint.h"
#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {

class EnergyTerms {
 public:
  // Body and terms outlive this.
  EnergyTerms(const Body& body, std::vector<DrivenTerm> driven);

  // Cliques that go beyond elements: those of driven terms.
  std::vector<Clique> cliques() const;
  void place_in(const BlockPattern& matrix);

  bool empty() const { return !fibres_ && driven_.empty(); }
  const std::vector<DrivenTerm>& driven() const { return driven_; }

  // Add the gradient [N] and return the energy [J]; `stored`: of fibres, which belong to the body.
  double add_stored_gradient(const Eigen::Matrix3Xd& positions_m, Eigen::Matrix3Xd& gradient_n) const;
  double add_driven_gradient(const Eigen::Matrix3Xd& positions_m, const SharedDrives& drives,
                             Eigen::Matrix3Xd& gradient_n) const;
  double add_gradient(const Eigen::Matrix3Xd& positions_m, const SharedDrives& drives,
                      Eigen::Matrix3Xd& gradient_n) const {
    return add_stored_gradient(positions_m, gradient_n) + add_driven_gradient(positions_m, drives, gradient_n);
  }
  void add_hessian(const Eigen::Matrix3Xd& positions_m, const SharedDrives& drives, bool convex,
                   BlockMatrix& matrix) const;

 private:
  std::unique_ptr<const FibreTerm> fibres_;  // null where there is none
  std::vector<DrivenTerm> driven_;
  std::vector<CliquePlaces> places_;  // of fibres, then of the driven ones
};

}  // namespace soft_robot_lab
