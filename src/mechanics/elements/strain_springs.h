// SPDX-License-Identifier: BSD-3-Clause
// Springs on the strain of every quadrature point: energy  sum_q w kappa/2 |E - E*|^2,  E = (F^T F - I) / 2.
// Within a time step viscosity and hysteresis are such springs, which pull towards the strain they come from. A
// polynomial of degree four, finite for inverted elements.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "mechanics/linear_algebra/block_matrix.h"
#include "element_batches.h"

namespace soft_robot_lab {

// E of all quadrature points: batch x Q x (xx, yy, zz, xy, xz, yz).
using Strains = Batches;

// As plain numbers, lane after lane, for states.
Eigen::VectorXd numbers_of(const Strains& strains);
Strains strains_of(const Eigen::VectorXd& numbers);

struct StrainTarget {
  double stiffness_pa = 0.0;  // kappa of Body::material; other silicone has it by the ratio of their mu
  Strains target;             // E*
  // And of the volume, whose stiffness is lambda: an element has 1/2 volume_ratio lambda V0 (Jbar - 1 - volume_from)^2
  // more, which its multiplier takes with its own, so that what is nearly incompressible solves as before. Zero and
  // empty: it has none.
  double volume_ratio = 0.0;
  Eigen::VectorXd volume_from = {};  // per multiplier

  // Where both together would be free: lambda (1 + ratio) / 2 (Jbar - 1 - free)^2, but for a constant.
  Eigen::VectorXd free_volume() const { return volume_ratio / (1.0 + volume_ratio) * volume_from; }
};

class StrainSprings {
 public:
  // References to what Elements has: its batches, and the matrix's slots per batch and pair of nodes.
  StrainSprings(const ElementBatches& batches, const std::vector<int>& slots) : batches_(batches), slots_(slots) {}

  Eigen::Index strain_count() const { return static_cast<Eigen::Index>(batch_count()) * kLanes; }
  std::size_t batch_count() const { return static_cast<std::size_t>(batches_.count()) * batches_.point_count * 6; }
  Strains strains(const Eigen::Matrix3Xd& positions_m) const;

  // Adds the gradient [N]; returns the energy [J].
  double add_gradient(const Eigen::Matrix3Xd& positions_m, const StrainTarget& strain_target,
                      Eigen::Matrix3Xd& forces_n) const;

  // `convex` adds what makes every quadrature point's Hessian positive.
  void add_hessian(const Eigen::Matrix3Xd& positions_m, const StrainTarget& strain_target, bool convex,
                   BlockMatrix& matrix) const;

 private:
  const ElementBatches& batches_;
  const std::vector<int>& slots_;
};

}  // namespace soft_robot_lab
