// SPDX-License-Identifier: BSD-3-Clause
// Where a long step of Newton's method leads once the body turns with it. Taken as it is, a step stretches all that it
// turns by the square of the angle, and a line search would cut it for that. So the step is read as a small rotation
// and a small strain of every quadrature point, grad d F^-1 = [w]x + e, and the nodes go where deformation gradients
// come nearest to those that rotation and strain lead to (rotation-strain coordinates: Huang, Tong, Zhou, Bao, Desbrun
// 2011, IEEE TVCG 17(7)):
//   min_x' sum_q w mu |grad x' - T F|^2,   T = s exp([w]x) (I + e),   det T = 1 + tr e, the volume that the step meant
// To first order that is x + d, so what is known of the step where it begins still holds.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCholesky>

#include "mechanics/linear_algebra/block_matrix.h"
#include "mechanics/elements/element_batches.h"
#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {

class CoRotatedStep {
 public:
  // `batches` holds all elements of the body, and must outlive this; `matrix` gives a good order of elimination.
  CoRotatedStep(const Body& body, const ElementBatches& batches, const BlockPattern& matrix);

  // From `positions_m` by `step_m`, which does not move what is held; 3 x nodes. An element that is inverted there, or
  // would be after the step's strain, takes the step as it is.
  Eigen::Matrix3Xd follow(const Eigen::Matrix3Xd& positions_m, const Eigen::Matrix3Xd& step_m) const;

 private:
  struct Poisson {          // for one axis
    std::vector<int> free;  // nodes, in order of elimination
    Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>> laplacian;
  };

  std::shared_ptr<const Poisson> poisson(const Eigen::Matrix<bool, 1, Eigen::Dynamic>& held,
                                         const BlockPattern& matrix) const;

  const ElementBatches& batches_;
  double mu_pa_;
  std::array<std::shared_ptr<const Poisson>, 3> axes_;
};

}  // namespace soft_robot_lab
