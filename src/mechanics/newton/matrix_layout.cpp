// SPDX-License-Identifier: BSD-3-Clause
#include "matrix_layout.h"

#include <algorithm>
#include <utility>

#include "mechanics/elements/volume_patches.h"

namespace soft_robot_lab {

MatrixLayout::MatrixLayout(const Body& body, const std::vector<DrivenConstraint>& constraints)
    : node_count(body.mesh().node_count()) {
  for (const auto& [constraint, actuator] : constraints) {
    std::vector<int> places;
    for (const EmbeddedPoint& point : constraint->carried_points()) places.push_back(place_of(point));
    cliques.emplace_back();
    for (Clique clique : constraint->cliques()) {
      for (int& member : clique)
        if (member < 0) member = places[~member];
      cliques.back().push_back(std::move(clique));
    }
  }
}

int MatrixLayout::place_of(const EmbeddedPoint& point) {
  for (int i = 0; i < point_count; ++i)
    if (std::equal(point.nodes.begin(), point.nodes.end(), ties[i].begin(), ties[i].end() - 1) &&
        std::equal(point.weights.begin(), point.weights.end(), tie_coefficients[i].begin(),
                   tie_coefficients[i].end() - 1))
      return node_count + i;
  ties.push_back(point.nodes);
  tie_coefficients.push_back(point.weights);
  ties.back().push_back(node_count + point_count);
  tie_coefficients.back().push_back(-1.0);
  return node_count + point_count++;
}

std::vector<std::vector<int>> MatrixLayout::all_cliques(const Body& body, const std::vector<Clique>& others) const {
  std::vector<std::vector<int>> all = ties;
  const auto of_elements = stiffness_cliques(body);
  all.insert(all.end(), of_elements.begin(), of_elements.end());
  for (const auto& of_constraint : cliques) all.insert(all.end(), of_constraint.begin(), of_constraint.end());
  all.insert(all.end(), others.begin(), others.end());
  return all;
}

}  // namespace soft_robot_lab
