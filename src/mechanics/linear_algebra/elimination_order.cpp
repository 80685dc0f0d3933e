// SPDX-License-Identifier: BSD-3-Clause
#include "elimination_order.h"

#include <algorithm>

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <metis.h>

namespace soft_robot_lab {
namespace {

// Deterministic for a fixed seed; nothing where METIS refuses. METIS_NodeND finds the same order, but takes SIGTERM for
// itself meanwhile: a first one jumps out of what allocates, a second one ends the program. This entry does not.
std::vector<int> nested_dissection(const Neighbours& neighbours) {
  const auto count = static_cast<idx_t>(neighbours.size());
  std::vector<idx_t> start{0}, adjacent;
  for (const auto& list : neighbours) {
    adjacent.insert(adjacent.end(), list.begin(), list.end());
    start.push_back(static_cast<idx_t>(adjacent.size()));
  }
  std::vector<idx_t> order(count), inverse(count);
  idx_t options[METIS_NOPTIONS], size_of_part = 0;
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = 1;
  const int status = METIS_NodeNDP(count, start.data(), adjacent.data(), nullptr, 1, options, order.data(),
                                   inverse.data(), &size_of_part);
  if (status != METIS_OK) return {};
  return {order.begin(), order.end()};
}

std::vector<int> minimum_degree(const Neighbours& neighbours) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int a = 0; a < static_cast<int>(neighbours.size()); ++a) {
    entries.emplace_back(a, a, 1.0);  // Eigen eliminates nodes without one last
    for (const int b : neighbours[a]) entries.emplace_back(a, b, 1.0);
  }
  const auto count = static_cast<Eigen::Index>(neighbours.size());
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::AMDOrdering<int>::PermutationType order;
  Eigen::AMDOrdering<int>()(matrix, order);
  return {order.indices().begin(), order.indices().end()};
}

struct EliminationTree {
  std::vector<int> position;  // per node
  std::vector<int> parent;    // per position, -1 at a root
};

EliminationTree elimination_tree(const std::vector<int>& order, const Neighbours& neighbours) {
  const auto count = static_cast<int>(order.size());
  EliminationTree tree{std::vector<int>(count), std::vector<int>(count, -1)};
  std::vector<int> ancestor(count, -1);
  for (int i = 0; i < count; ++i) tree.position[order[i]] = i;
  for (int i = 0; i < count; ++i) {
    for (const int neighbour : neighbours[order[i]]) {
      for (int j = tree.position[neighbour]; j != -1 && j < i;) {
        const int next = ancestor[j];
        ancestor[j] = i;
        if (next == -1) tree.parent[j] = i;
        j = next;
      }
    }
  }
  return tree;
}

}  // namespace

std::vector<int> elimination_order(const Neighbours& neighbours) {
  std::vector<int> order = minimum_degree(neighbours);
  const bool coupled =
      std::any_of(neighbours.begin(), neighbours.end(), [](const auto& list) { return !list.empty(); });
  if (!coupled) return order;  // METIS refuses those
  std::vector<int> dissected = nested_dissection(neighbours);
  if (dissected.empty()) return order;
  return factor_operations(order, neighbours) < factor_operations(dissected, neighbours) ? order : dissected;
}

std::vector<int> postorder(const std::vector<int>& order, const Neighbours& neighbours) {
  const auto count = static_cast<int>(order.size());
  const std::vector<int> parent = elimination_tree(order, neighbours).parent;
  std::vector<std::vector<int>> children(count + 1);
  for (int i = 0; i < count; ++i) children[parent[i] == -1 ? count : parent[i]].push_back(i);
  std::vector<int> result, stack(children[count].rbegin(), children[count].rend());
  std::vector<char> open(count, 0);
  while (!stack.empty()) {
    const int top = stack.back();
    if (!open[top]) {
      open[top] = 1;
      stack.insert(stack.end(), children[top].rbegin(), children[top].rend());
    } else {
      stack.pop_back();
      result.push_back(order[top]);
    }
  }
  return result;
}

double factor_operations(const std::vector<int>& order, const Neighbours& neighbours) {
  const auto count = static_cast<int>(order.size());
  const EliminationTree tree = elimination_tree(order, neighbours);
  std::vector<int> entries(count, 1), seen_by(count, -1);
  // Row i of the factor has an entry in every column on the way from its entries in the matrix up to i.
  for (int i = 0; i < count; ++i) {
    seen_by[i] = i;
    for (const int neighbour : neighbours[order[i]]) {
      for (int j = tree.position[neighbour]; j < i && seen_by[j] != i; j = tree.parent[j]) {
        seen_by[j] = i;
        ++entries[j];
      }
    }
  }
  double operations = 0.0;
  for (const int column : entries) operations += static_cast<double>(column) * column;
  return operations;
}

}  // namespace soft_robot_lab
