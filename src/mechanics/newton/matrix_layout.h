// SPDX-License-Identifier: BSD-3-Clause
// Who is coupled with whom in Newton's matrix, and where. The mesh's nodes come first, then the constraints' carried
// points, each tied to its nodes by a spring that is stiff against everything it carries (so the second derivative is
// softened by less than 1e-3).
#pragma once

#include <vector>

#include "mechanics/state/driven_constraint.h"
#include "soft_robot_lab/mechanics/body.h"
#include "soft_robot_lab/mechanics/constraint.h"

namespace soft_robot_lab {

struct MatrixLayout {
  MatrixLayout(const Body& body, const std::vector<DrivenConstraint>& constraints);

  // Of the whole matrix: ties, elements, constraints, and these others.
  std::vector<std::vector<int>> all_cliques(const Body& body, const std::vector<Clique>& others) const;

  int node_count, point_count = 0;
  std::vector<std::vector<int>> ties;                 // per point: its nodes, then itself
  std::vector<std::vector<double>> tie_coefficients;  // its weights, then -1
  std::vector<std::vector<Clique>> cliques;           // per constraint, in places of the matrix

 private:
  int place_of(const EmbeddedPoint& point);  // a point that several constraints carry has one place
};

}  // namespace soft_robot_lab
