// SPDX-License-Identifier: BSD-3-Clause
// The further energies of the nodes that actuators hand out.
#pragma once

#include <vector>

#include "mechanics/elements/clique_adder.h"
#include "mechanics/linear_algebra/block_matrix.h"
#include "mechanics/state/driven_constraint.h"

namespace soft_robot_lab {

class EnergyTerms {
 public:
  explicit EnergyTerms(std::vector<DrivenTerm> driven);  // which outlive this

  std::vector<Clique> cliques() const;  // of all
  void place_in(const BlockPattern& matrix);

  bool empty() const { return driven_.empty(); }
  const std::vector<DrivenTerm>& driven() const { return driven_; }

  // Adds the gradient [N] and returns the energy [J].
  double add_gradient(const Eigen::Matrix3Xd& positions_m, const SharedDrives& drives,
                      Eigen::Matrix3Xd& gradient_n) const;
  void add_hessian(const Eigen::Matrix3Xd& positions_m, const SharedDrives& drives, bool convex,
                   BlockMatrix& matrix) const;

 private:
  std::vector<DrivenTerm> driven_;
  std::vector<CliquePlaces> places_;
};

}  // namespace soft_robot_lab
