// SPDX-License-Identifier: BSD-3-Clause
#include "substep_hysteresis.h"

#include <cmath>

namespace soft_robot_lab {

void SubstepHysteresis::begin(const Eigen::Matrix3Xd& positions_m, const Eigen::VectorXd& branch_stress_pa) {
  strains_ = springs_.strains(positions_m);
  stress_ = strains_of(branch_stress_pa);
  pull(positions_m);
}

// Q = exp(-t/tau) Q0 + g 2 mu tau/t (1 - exp(-t/tau)) (E - E0), exact where the strain changes evenly.
void SubstepHysteresis::follow(const Eigen::Matrix3Xd& positions_m, double time_s) {
  const Viscosity& viscosity = body_.viscosity();
  const double times = time_s / viscosity.relaxation_time_s, kept = std::exp(-times);
  const double stiffness_pa =
      2.0 * body_.material().lame_mu_pa() * viscosity.hysteresis_ratio * -std::expm1(-times) / times;
  Strains strains = springs_.strains(positions_m);
  for (std::size_t i = 0; i < stress_.size(); ++i)
    stress_[i] = kept * stress_[i] + stiffness_pa * (strains[i] - strains_[i]);
  strains_ = std::move(strains);
  pull(positions_m);
}

// Q is what springs of the branch's stiffness have, stretched by Q over it.
void SubstepHysteresis::pull(const Eigen::Matrix3Xd& positions_m) {
  StrainTarget springs;
  springs.stiffness_pa = 2.0 * body_.material().lame_mu_pa() * body_.viscosity().hysteresis_ratio;
  springs.target.resize(stress_.size());
  for (std::size_t i = 0; i < stress_.size(); ++i)
    springs.target[i] = strains_[i] - 1.0 / springs.stiffness_pa * stress_[i];
  gradient_n_ = Eigen::Matrix3Xd::Zero(3, positions_m.cols());
  energy_j_ = springs_.add_gradient(positions_m, springs, gradient_n_);
}

}  // namespace soft_robot_lab
