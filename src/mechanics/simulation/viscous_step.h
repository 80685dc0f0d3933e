// SPDX-License-Identifier: BSD-3-Clause
// Viscosity within one time step, as springs on the strain (strain_springs.h). Kelvin-Voigt, with the strain's rate
// from the integrator's own difference, dE/dt = (E - E_from) / gamma:
//   S = b 2 mu / gamma (E - E_from),   of the trapezoidal rule E_from = E0 + gamma dE/dt where the step starts
// and so of each element's volume the pressure  b lambda / gamma (Jbar - Jbar_from).
// The Prony branch, integrated exactly where the strain changes evenly over the step (Simo & Hughes 1998, 10.3.2):
//   Q = exp(-h/tau) Q0 + kappa (E - E0),   kappa = g 2 mu tau/h (1 - exp(-h/tau))
// which is second order in h and dissipates at any h. Both together are one spring. Stresses here and in the state are
// those of Body::material: other silicone has them by the ratio of their mu.
#pragma once

#include <memory>

#include "mechanics/state/backward_difference.h"
#include "mechanics/newton/newton_energies.h"
#include "soft_robot_lab/mechanics/body.h"
#include "soft_robot_lab/mechanics/simulation_state.h"

namespace soft_robot_lab {

// The springs whose stress is that of viscosity in a state that moves; null where there is none.
std::shared_ptr<const StrainTarget> viscosity_now(const Body& body, const NewtonEnergies& energies,
                                                  const SimulationState& state);

class ViscousStep {
 public:
  // A step of length h from `state`; does nothing where the body has no viscosity of strain.
  ViscousStep(const Body& body, const NewtonEnergies& energies, const SimulationState& state,
              const BackwardDifference& difference, double h);

  const std::shared_ptr<const StrainTarget>& strain_target() const {
    return strain_target_;
  }  // null where there is none

  // The branch's stress at the end of the step, in the state's order; empty where there is no branch.
  Eigen::VectorXd branch_stress_pa(const NewtonEnergies& energies, const Eigen::Matrix3Xd& positions_m) const;

 private:
  std::shared_ptr<const StrainTarget> strain_target_;
  double branch_stiffness_pa_ = 0.0;
  Strains branch_from_;  // the strain at which the branch would be free of stress
};

}  // namespace soft_robot_lab
