// SPDX-License-Identifier: BSD-3-Clause
// The factor of a rest state that saved states go on from: a search starts each of its trials from one of a few.
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "mechanics/contact/contact_touch.h"
#include "mechanics/contact/rigid_contact.h"
#include "mechanics/elements/elements.h"
#include "mechanics/linear_algebra/block_cholesky.h"
#include "mechanics/linear_algebra/block_matrix.h"
#include "mechanics/state/newton_state.h"

namespace soft_robot_lab {

// All that a linearisation leaves behind, as in NewtonSolver.
struct KeptFactor {
  std::weak_ptr<const Linearisation> of;  // expired where no state can ask for it any more
  BlockMatrix matrix;
  BlockCholesky factor;
  Elements::VolumeGradients volume_gradients;
  Eigen::MatrixXd border, border_solved, delassus;
  std::vector<ContactTouch> touches;
  RigidTouches rigid_touches;
};

}  // namespace soft_robot_lab
