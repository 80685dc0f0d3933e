// SPDX-License-Identifier: BSD-3-Clause
#include "energy_terms.h"

#include <utility>

namespace soft_robot_lab {

EnergyTerms::EnergyTerms(std::vector<DrivenTerm> driven) : driven_(std::move(driven)) {}

std::vector<Clique> EnergyTerms::cliques() const {
  std::vector<Clique> all;
  for (const DrivenTerm& driven : driven_) {
    const std::vector<Clique> more = driven.term->cliques();
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

void EnergyTerms::place_in(const BlockPattern& matrix) {
  for (const DrivenTerm& driven : driven_) places_.emplace_back(matrix, driven.term->cliques());
}

double EnergyTerms::add_gradient(const Eigen::Matrix3Xd& positions_m, const SharedDrives& drives,
                                 Eigen::Matrix3Xd& gradient_n) const {
  double energy_j = 0.0;
  for (const DrivenTerm& driven : driven_)
    energy_j += driven.term->add_gradient(positions_m, driven.drive(drives), gradient_n);
  return energy_j;
}

void EnergyTerms::add_hessian(const Eigen::Matrix3Xd& positions_m, const SharedDrives& drives, bool convex,
                              BlockMatrix& matrix) const {
  for (std::size_t i = 0; i < driven_.size(); ++i) {
    CliqueAdder adder(matrix, places_[i]);
    driven_[i].term->add_hessian(positions_m, driven_[i].drive(drives), convex, adder);
  }
}

}  // namespace soft_robot_lab
