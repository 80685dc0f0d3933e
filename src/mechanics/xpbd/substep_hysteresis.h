// SPDX-License-Identifier: BSD-3-Clause
// The branch of hysteresis (viscosity.h) in the substeps of xpbd. It is soft beside the silicone, so its stress pulls
// in a substep as the one before left it.
#pragma once

#include <Eigen/Core>

#include "mechanics/elements/strain_springs.h"
#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {

class SubstepHysteresis {
 public:
  // Both outlive this; the body has hysteresis.
  SubstepHysteresis(const Body& body, const StrainSprings& springs) : body_(body), springs_(springs) {}

  // Takes up the stress, in the state's order, where a step begins; and follows it to where a substep ended.
  void begin(const Eigen::Matrix3Xd& positions_m, const Eigen::VectorXd& branch_stress_pa);
  void follow(const Eigen::Matrix3Xd& positions_m, double time_s);

  const Eigen::Matrix3Xd& gradient_n() const { return gradient_n_; }  // of its energy, 3 x nodes
  double energy_j() const { return energy_j_; }
  Eigen::VectorXd stress_pa() const { return numbers_of(stress_); }

 private:
  void pull(const Eigen::Matrix3Xd& positions_m);

  const Body& body_;
  const StrainSprings& springs_;
  Strains strains_, stress_;
  Eigen::Matrix3Xd gradient_n_;
  double energy_j_ = 0.0;
};

}  // namespace soft_robot_lab
