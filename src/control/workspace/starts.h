// SPDX-License-Identifier: BSD-3-Clause
// Which equilibrium the search for each point of a workspace starts from: a neighbour's that is nearer to rest. So the
// points are a tree, and what is found hangs neither on the number of threads nor on where an earlier run stopped.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace soft_robot_lab {

constexpr int kFromRest = -1;

// Of a grid whose last command runs fastest. `steps`: of each command; `rest`: the place on the grid that is nearest to
// the rest command. The way leads along the command that is pulled most and then along the others, so that two cables
// against each other bend a body before they compress it, and mirror images are found as mirror images.
std::vector<int> grid_starts(const std::vector<int>& steps, const std::vector<int>& rest);

// Of points anywhere, a column each, as fractions of the commands' ranges: the nearest of the points that are nearer to
// `rest`, or the rest itself.
std::vector<int> nearest_starts(const Eigen::MatrixXd& points, const Eigen::VectorXd& rest);

// Pairs of a grid's neighbours, each once.
struct NeighbourPair {
  int from, to;
};
std::vector<NeighbourPair> grid_neighbours(const std::vector<int>& steps);

}  // namespace soft_robot_lab
