// SPDX-License-Identifier: BSD-3-Clause
#include "energy_terms.h"

#include <utility>

namespace soft_robot_lab {

EnergyTerms::EnergyTerms(const Body& body, std::vector<DrivenTerm> driven) : driven_(std::move(driven)) {
  if (!body.fibre_groups().empty()) fibres_ = std::make_unique<const FibreTerm>(body);
}

std::vector<Clique> EnergyTerms::cliques() const {
  std::vector<Clique> all;
  for (const DrivenTerm& driven : driven_) {
    const std::vector<Clique> more = driven.term->cliques();
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

void EnergyTerms::place_in(const BlockPattern& matrix) {
  if (fibres_) places_.emplace_back(matrix, fibres_->cliques());
  for (const DrivenTerm& driven : driven_) places_.emplace_back(matrix, driven.term->cliques());
}

double EnergyTerms::add_stored_gradient(const Eigen::Matrix3Xd& positions_m, Eigen::Matrix3Xd& gradient_n) const {
  return fibres_ ? fibres_->add_gradient(positions_m, {}, gradient_n) : 0.0;
}

double EnergyTerms::add_driven_gradient(const Eigen::Matrix3Xd& positions_m, const SharedDrives& drives,
                                        Eigen::Matrix3Xd& gradient_n) const {
  double energy_j = 0.0;
  for (const DrivenTerm& driven : driven_)
    energy_j += driven.term->add_gradient(positions_m, driven.drive(drives), gradient_n);
  return energy_j;
}

void EnergyTerms::add_hessian(const Eigen::Matrix3Xd& positions_m, const SharedDrives& drives, bool convex,
                              BlockMatrix& matrix) const {
  std::size_t at = 0;
  if (fibres_) {
    CliqueAdder adder(matrix, places_[at++]);
    fibres_->add_hessian(positions_m, {}, convex, adder);
  }
  for (const DrivenTerm& driven : driven_) {
    CliqueAdder adder(matrix, places_[at++]);
    driven.term->add_hessian(positions_m, driven.drive(drives), convex, adder);
  }
}

}  // namespace soft_robot_lab
