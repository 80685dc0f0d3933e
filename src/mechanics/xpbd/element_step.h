// SPDX-License-Identifier: BSD-3-Clause
// The XPBD correction of whole elements, four at a time; the formula stands in xpbd_solver.h. What it takes to invert
// an element's matrix S is kept while the element turns, and made again where it has strained or its pressure changed:
//   S = S_0 + h^2 lambda/V w w^T,   w = M^-1/2 g,   g = d(V Jbar)/dx
// S_0^-1 and the answer S_0^-1 w to a pressure turn with the element; w and all forces are those of the moment, so that
// what is kept decides how fast elements come to their forces, and not to which.
#pragma once

#include <vector>

#include "mechanics/elements/element_batches.h"
#include "mechanics/state/newton_state.h"

namespace soft_robot_lab {

// Where the matrices of elements were made: all that decides what is kept of them. It stands in a state where newton's
// linearisation would, and says of that nothing.
struct KeptSolves : Linearisation {
  double time_step_s = 0.0, dashpot = 0.0;  // as ElementStep's
  Batches positions_m;                      // batch x 3 P
  Batches multipliers_pa;                   // batch
};

// What is kept, and one thread's own.
struct ElementSolves {
  ElementSolves(const ElementBatches& batches, const double* root_inverse_masses);

  void restore(const KeptSolves& kept);  // all is made again, when it is needed, that was made elsewhere

  enum Known : char { kNone, kAsked, kMade };  // nothing; where it was made; it itself
  KeptSolves made;
  std::vector<char> known;  // per batch
  std::vector<char> fresh;  // per batch: made since this was last cleared
  Batches held;             // batch: 1 in lanes that hold a node, and so do not turn
  Batches inverses;         // batch x pair (a >= b) x 9, S_0^-1
  Batches answers;          // batch x 3 P, S_0^-1 w
  Batches unstrained;       // batch x 9, F^-1 of the mean F, by rows
};

struct ElementStep {
  double time_step_s;
  const double* root_inverse_masses;  // 3 * node + axis: 1/sqrt(mass) [kg^-1/2], zero where held
  double* positions_m;                // 3 * node + axis
  Batch* multipliers;                 // batch x 3 P: minus the nodes' forces, times h^2 / sqrt(mass) [m kg^1/2]
  double* volume_multipliers_pa;      // per element: p, in and out
  // Of Kelvin-Voigt (viscosity.h): where the substep began, null without any; and b / h.
  const double* start_m = nullptr;
  double dashpot = 0.0;
};

// Batches of one colour, from `first` up to `last`, moved one step towards their own equilibrium.
void move_elements(const ElementBatches& batches, int first, int last, const ElementStep& step, ElementSolves& solves);

// Stored energy of each element, in lanes [J].
void measure_energy(const ElementBatches& batches, const double* positions_m, Batch* energies);

}  // namespace soft_robot_lab
