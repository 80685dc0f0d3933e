// SPDX-License-Identifier: BSD-3-Clause
// Where the energy of a simulation in time is, and where it went. All in J.
//   kinetic + elastic + gravity + loads, at the end less at the start
//     = actuators + gas + holds + obstacles + rescues - material - friction - integrator + closure error
#pragma once

namespace soft_robot_lab {

struct EnergyLedger {
  // Stored. The potentials of gravity and of dead loads are zero in the rest shape.
  double kinetic_j = 0.0, elastic_j = 0.0, gravity_j = 0.0, loads_j = 0.0;

  // Since the ledger began: work on the body.
  double actuators_j = 0.0;  // of drives, but for gas
  double gas_j = 0.0;        // of the gas in chambers, against that around the body
  double holds_j = 0.0;      // of held regions that move
  double obstacles_j = 0.0;  // of contact, before friction takes its part
  double rescues_j = 0.0;    // of shapes that were laid out anew, of steps that found no solution, and of bodies put to
                             // sleep (negative)

  // Since the ledger began: dissipated.
  double material_j = 0.0;    // damping, and hysteresis with what its branch still stores
  double friction_j = 0.0;    // of cables and contacts
  double integrator_j = 0.0;  // of no physics: what the rule of integration takes, or gives where negative

  double closure_error_j = 0.0;  // what is left over
  double turned_over_j = 0.0;    // half of the sum of all changes, step by step
};

}  // namespace soft_robot_lab
