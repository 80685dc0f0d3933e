// SPDX-License-Identifier: BSD-3-Clause
// The rest shape of tetrahedra and their materials, laid out four at a time for the kernels: P nodes and Q quadrature
// points an element.
#pragma once

#include <vector>

#include "mechanics/linear_algebra/batches.h"
#include "mechanics/material/material_law.h"
#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {

struct ElementBatches {
  // `lanes`: the element in each lane, a multiple of kLanes; ~element marks an unused lane, which repeats that element
  // with no weight. The nodes of an element are sorted by `rank`, one number a node.
  ElementBatches(const Body& body, std::vector<int> lanes, const std::vector<int>& rank);

  int count() const { return static_cast<int>(element.size()) / kLanes; }
  int pair_count() const { return node_count * (node_count + 1) / 2; }

  int node_count, point_count;  // P, Q
  std::vector<int> element;     // batch x lanes
  std::vector<int> nodes;       // batch x P x lanes
  Batches gradients;            // batch x Q x P x 3: rest gradients [1/m]
  Batches weights;              // batch x Q: rest volumes of the points [m^3]
  Batches laplacian;            // batch x pair (a >= b): mu sum_q w (grad a . grad b) [N/m]
  MaterialLaws laws;            // batch
  Batches lambda_pa, mu_pa;     // batch: of the volumetric term; shear modulus
  Batches mu_ratio;             // batch: mu over that of Body::material
};

}  // namespace soft_robot_lab
