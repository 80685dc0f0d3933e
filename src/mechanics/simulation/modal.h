// SPDX-License-Identifier: BSD-3-Clause
// Undamped small vibrations of a body about its rest shape: K phi = (2 pi f)^2 M phi. Loads, gravity and actuators play
// no part.
#pragma once

#include <Eigen/Core>

#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {

struct ModalResult {
  bool converged = false;
  int iterations = 0;   // of the subspace, one block solve each
  double change = 0.0;  // largest relative change of a squared frequency in the last iteration
  double wall_s = 0.0;
  Eigen::VectorXd frequencies_hz;  // ascending; a motion that nothing resists has zero
  Eigen::MatrixXd shapes;          // per mode: displacements over 3*node + axis, modal mass 1 kg (unit: m)
};

// As many as can be asked for: 100, or the free degrees of freedom where there are fewer.
int most_modes(const Body& body);

// The lowest modes. Throws std::invalid_argument where `modes` is not within 1 and most_modes.
ModalResult modal_analysis(const Body& body, int modes);

}  // namespace soft_robot_lab
