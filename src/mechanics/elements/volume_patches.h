// SPDX-License-Identifier: BSD-3-Clause
// Linear tetrahedra whose volume is averaged over those around a vertex (Bonet & Burton 1998, "A simple average nodal
// pressure tetrahedral element"), as compliant constraints, one multiplier p a vertex v. Each element gives a quarter
// of its rest volume V_e to each of its vertices:
//   V_v = sum_e V_e / 4,   Jbar_v = sum_e V_e J_e / (4 V_v),   energy  sum_v lambda/2 V_v (Jbar_v - 1)^2
// An element then feels the mean of its vertices' p. All nodes around a vertex are coupled.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "mechanics/linear_algebra/block_matrix.h"
#include "element_batches.h"
#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {

// Sets of nodes that the elements of a body couple with one another.
std::vector<std::vector<int>> stiffness_cliques(const Body& body);

class VolumePatches {
 public:
  VolumePatches(const ElementBatches& batches, const Eigen::VectorXd& element_volumes_m3, const BlockPattern& matrix);

  const Eigen::VectorXd& volumes_m3() const { return volumes_; }  // V_v

  // From vertices to elements: a quarter of the sum over an element's vertices; and back: over a vertex's elements.
  Eigen::VectorXd on_elements(const Eigen::VectorXd& of_vertices) const;
  Eigen::VectorXd on_vertices(const Eigen::VectorXd& of_elements) const;

  // Adds lambda / V_v g g^T for every vertex, g = d(V_v Jbar_v)/dx. `gradients`: d(V_e J_e)/dx in batches.
  void add_hessian(const Batches& gradients, double lambda_pa, BlockMatrix& matrix) const;

 private:
  struct Share {
    int element;
    std::array<int, 4> places;  // of its nodes, in the order of the batches, within the patch
  };
  struct Patch {
    std::vector<Share> fractions;
    int node_count = 0;
    std::vector<int> slots;  // of the matrix, per pair (a >= b) of nodes sorted by elimination order
  };
  std::vector<std::array<int, 4>> vertices_;  // per element
  std::vector<Patch> patches_;                // per vertex
  Eigen::VectorXd volumes_;
};

}  // namespace soft_robot_lab
