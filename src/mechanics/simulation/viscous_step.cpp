// SPDX-License-Identifier: BSD-3-Clause
#include "viscous_step.h"

#include <cmath>

namespace soft_robot_lab {
namespace {

// a x + b y
Strains combined(double a, const Strains& x, double b, const Strains& y) {
  Strains result(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) result[i] = a * x[i] + b * y[i];
  return result;
}

// How the strain changes in a time at the velocity of now: strains are quadratic in the positions, so the central
// difference is their rate to the last bit.
Strains strain_change(const NewtonEnergies& energies, const SimulationState& state, double time_s) {
  const Eigen::Matrix3Xd way_m = time_s * state.velocities_m_s;
  return combined(0.5, energies.springs.strains(state.positions_m + way_m), -0.5,
                  energies.springs.strains(state.positions_m - way_m));
}

// From where the strain comes, of which the rate is (E - from) / gamma.
Strains strain_from(const NewtonEnergies& energies, const SimulationState& state, const BackwardDifference& difference,
                    const Strains& start) {
  if (difference.trapezoidal) return combined(1.0, start, 1.0, strain_change(energies, state, difference.gamma_s));
  if (difference.weight_before == 0.0) return start;
  return combined(difference.weight_now, start, -difference.weight_before,
                  energies.springs.strains(state.previous_positions_m));
}

// The same of Jbar - 1, which is cubic: over a small part of the time.
Eigen::VectorXd volume_change(const NewtonEnergies& energies, const SimulationState& state, double time_s) {
  constexpr double kPart = 1e-3;
  const Eigen::Matrix3Xd way_m = kPart * time_s * state.velocities_m_s;
  return (energies.sums_at(state.positions_m + way_m).volumetric_strain -
          energies.sums_at(state.positions_m - way_m).volumetric_strain) /
         (2.0 * kPart);
}

Eigen::VectorXd volume_from(const NewtonEnergies& energies, const SimulationState& state,
                            const BackwardDifference& difference) {
  const Eigen::VectorXd start = energies.sums_at(state.positions_m).volumetric_strain;
  if (difference.trapezoidal) return start + volume_change(energies, state, difference.gamma_s);
  if (difference.weight_before == 0.0) return start;
  return difference.weight_now * start -
         difference.weight_before * energies.sums_at(state.previous_positions_m).volumetric_strain;
}

// Fibres, whose strains are the last, have no damping.
Eigen::VectorXd of_volumes(const NewtonEnergies& energies, Eigen::VectorXd strains) {
  strains.tail(energies.elements.fibre_count()).setZero();
  return strains;
}

}  // namespace

// S = kappa (E - E*) = b 2 mu dE/dt + Q
std::shared_ptr<const StrainTarget> viscosity_now(const Body& body, const NewtonEnergies& energies,
                                                  const SimulationState& state) {
  const Viscosity& viscosity = body.viscosity();
  if (!viscosity.of_strain()) return nullptr;
  auto springs = std::make_shared<StrainTarget>();
  springs->stiffness_pa = 2.0 * body.material().lame_mu_pa();
  springs->target = energies.springs.strains(state.positions_m);
  if (viscosity.rayleigh_stiffness_s > 0.0) {
    springs->target =
        combined(1.0, springs->target, -1.0, strain_change(energies, state, viscosity.rayleigh_stiffness_s));
    springs->volume_ratio = 1.0;
    springs->volume_from = of_volumes(energies, energies.sums_at(state.positions_m).volumetric_strain -
                                                    volume_change(energies, state, viscosity.rayleigh_stiffness_s));
  }
  if (viscosity.hysteresis_ratio > 0.0)
    springs->target = combined(1.0, springs->target, -1.0 / springs->stiffness_pa, strains_of(state.branch_stress_pa));
  return springs;
}

ViscousStep::ViscousStep(const Body& body, const NewtonEnergies& energies, const SimulationState& state,
                         const BackwardDifference& difference, double h) {
  const Viscosity& viscosity = body.viscosity();
  if (!viscosity.of_strain()) return;
  const double twice_mu_pa = 2.0 * body.material().lame_mu_pa();
  const Strains start = energies.springs.strains(state.positions_m);
  auto strain_target = std::make_shared<StrainTarget>();
  if (viscosity.rayleigh_stiffness_s > 0.0) {
    strain_target->stiffness_pa = viscosity.rayleigh_stiffness_s * twice_mu_pa / difference.gamma_s;
    strain_target->target = strain_from(energies, state, difference, start);
    strain_target->volume_ratio = viscosity.rayleigh_stiffness_s / difference.gamma_s;
    strain_target->volume_from = of_volumes(energies, volume_from(energies, state, difference));
  }
  if (viscosity.hysteresis_ratio > 0.0) {
    const double steps = h / viscosity.relaxation_time_s;
    branch_stiffness_pa_ = viscosity.hysteresis_ratio * twice_mu_pa * -std::expm1(-steps) / steps;
    branch_from_ = combined(1.0, start, -std::exp(-steps) / branch_stiffness_pa_, strains_of(state.branch_stress_pa));
    const double both_pa = strain_target->stiffness_pa + branch_stiffness_pa_;
    strain_target->target = strain_target->stiffness_pa > 0.0
                                ? combined(strain_target->stiffness_pa / both_pa, strain_target->target,
                                           branch_stiffness_pa_ / both_pa, branch_from_)
                                : branch_from_;
    strain_target->stiffness_pa = both_pa;
  }
  strain_target_ = std::move(strain_target);
}

Eigen::VectorXd ViscousStep::branch_stress_pa(const NewtonEnergies& energies,
                                              const Eigen::Matrix3Xd& positions_m) const {
  if (branch_from_.empty()) return {};
  return numbers_of(
      combined(branch_stiffness_pa_, energies.springs.strains(positions_m), -branch_stiffness_pa_, branch_from_));
}

}  // namespace soft_robot_lab
