// SPDX-License-Identifier: BSD-3-Clause
// The XPBD correction of whole elements, four at a time; the formula stands in xpbd_solver.h.
#pragma once

#include "mechanics/elements/element_batches.h"

namespace soft_robot_lab {

struct ElementStep {
  double time_step_s;
  const double* root_inverse_masses;  // 3 * node + axis: 1/sqrt(mass) [kg^-1/2], zero where held
  double* positions_m;                // 3 * node + axis
  Batch* multipliers;                 // batch x 3 P: minus the nodes' forces, times h^2 / sqrt(mass) [m kg^1/2]
  double* volume_multipliers_pa;      // per element: p, in and out
};

// Batches of one colour, from `first` up to `last`, moved one step towards their own equilibrium.
void move_elements(const ElementBatches& batches, int first, int last, const ElementStep& step);

// Stored energy of each element, in lanes [J].
void measure_energy(const ElementBatches& batches, const double* positions_m, Batch* energies);

}  // namespace soft_robot_lab
