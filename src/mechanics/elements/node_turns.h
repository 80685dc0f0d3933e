// SPDX-License-Identifier: BSD-3-Clause
// How far each node of a body has turned between two shapes. A matrix that was made at the first one serves the second
// better once it turns with the nodes: bending changes little else of it.
#pragma once

#include <Eigen/Core>

#include "element_batches.h"
#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {

// A rotation per node, one after the other: 3 x 3 nodes, filled up to whole batches. No columns: nothing has turned.
using Turns = Eigen::Matrix3Xd;

Eigen::Matrix3Xd turned(const Turns& turns, const Eigen::Matrix3Xd& vectors);
Eigen::Matrix3Xd turned_back(const Turns& turns, const Eigen::Matrix3Xd& vectors);

class NodeTurns {
 public:
  // `batches` holds all elements of the body; both must outlive this.
  NodeTurns(const Body& body, const ElementBatches& batches);

  // The rotation nearest to the mean of F_to F_from^-1 over the elements of each node, by their volumes. A node that is
  // held along any axis keeps its axes, and so does one whose elements are turned inside out.
  Turns between(const Eigen::Matrix3Xd& from_m, const Eigen::Matrix3Xd& to_m) const;

 private:
  const Body& body_;
  const ElementBatches& batches_;
  Batches gradients_;  // batch x P x 3: means over each element [1/m]
  Batches volumes_;    // batch [m^3]
};

}  // namespace soft_robot_lab
