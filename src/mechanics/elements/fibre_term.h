// SPDX-License-Identifier: BSD-3-Clause
// The energy of a body's fibres (FibreGroup). With e, the mean stretch of a group less one, L its length at rest:
//   E A L phi(e),   phi = e^2 / 2;   of threads that cannot push, below zero a tension that falls to -d/2 within d.
// So at rest they are as stiff as under tension, and their tension has no kink but one of its slope.
#pragma once

#include <vector>

#include "soft_robot_lab/mechanics/body.h"
#include "soft_robot_lab/mechanics/constraint.h"

namespace soft_robot_lab {

class FibreTerm : public EnergyTerm {
 public:
  explicit FibreTerm(const Body& body) : body_(body) {}  // which outlives this

  std::vector<Clique> cliques() const override;  // the nodes of each group's element
  double add_gradient(const Eigen::Matrix3Xd& positions_m, const DriveState& unused,
                      Eigen::Matrix3Xd& gradient_n) const override;
  void add_hessian(const Eigen::Matrix3Xd& positions_m, const DriveState& unused, bool convex,
                   CliqueSink& hessian) const override;

 private:
  const Body& body_;
};

// Of threads at a strain: energy per length, tension and stiffness, each over E A.
struct ThreadLaw {
  double energy, tension, slope;
};
ThreadLaw thread_law(double strain, bool only_tension);

}  // namespace soft_robot_lab
