// SPDX-License-Identifier: BSD-3-Clause
// The order in which the nodes of a symmetric matrix are eliminated.
#pragma once

#include <vector>

namespace soft_robot_lab {

using Neighbours = std::vector<std::vector<int>>;  // per node, sorted, without the node itself

// Nodes, the first to be eliminated first: by nested dissection (METIS) or by approximate minimum degree (Amestoy,
// Davis and Duff 1996, in Eigen), whichever takes the fewest operations. Slender bodies mostly take the latter, thick
// ones the former. Where METIS refuses it is the latter.
std::vector<int> elimination_order(const Neighbours& neighbours);

// Renumbers so that every subtree of the elimination tree is contiguous; the factor's size stays the same.
std::vector<int> postorder(const std::vector<int>& order, const Neighbours& neighbours);

// Of a Cholesky factorisation in that order, to leading order: the sum of the squares of its columns' entries.
double factor_operations(const std::vector<int>& order, const Neighbours& neighbours);

}  // namespace soft_robot_lab
