// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace soft_robot_lab {

// What a silicone body loses its energy by, beside what the integrator takes. None by default, and then none costs any
// time. With E the Green strain, which no rigid motion changes, S the second Piola-Kirchhoff stress and mu the shear
// modulus:
//   rayleigh_mass_per_s a      force -a M v, as in a viscous medium; damps also the motion as a whole
//   rayleigh_stiffness_s b     S = b 2 mu dE/dt (Kelvin-Voigt), and of each element's volume the pressure b lambda
//                              dJbar/dt: Rayleigh's b K v at small strain, at every Poisson's ratio
//   hysteresis_ratio g, relaxation_time_s tau    one branch of a Prony series: S = Q, dQ/dt = g 2 mu dE/dt - Q / tau
// A mode of frequency omega decays as exp(-(a + b omega^2) t / 2). None changes where a body comes to rest.
struct Viscosity {
  double rayleigh_mass_per_s = 0.0;   // [0, inf)
  double rayleigh_stiffness_s = 0.0;  // [0, inf)
  double hysteresis_ratio = 0.0;      // [0, inf); stiffness of the branch over that at rest
  double relaxation_time_s = 1.0;     // (0, inf)

  bool of_strain() const { return rayleigh_stiffness_s > 0.0 || hysteresis_ratio > 0.0; }
  void validate() const;  // throws std::invalid_argument: field, value, allowed range
};

}  // namespace soft_robot_lab
