// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

namespace soft_robot_lab {

struct MeshQuality {
  double min = 0.0;
  double mean = 0.0;
};

// Radius ratio of the elements' corners, 3 * inscribed / circumscribed radius: 1 for a regular tetrahedron, 0 for a
// flat one, negative for an inverted one. Nodes are 3 x n, elements 4 or 10 x m; curved edges count as straight.
MeshQuality measure_quality(const Eigen::Matrix3Xd& nodes_m, const Eigen::MatrixXi& tets);

// Of each element's corners 6 sqrt(2) volume / (root mean square of the edges)^3, called Q_vl: 1 for a regular
// tetrahedron, 0 for a flat one, negative for an inverted one. Parthasarathy, Graichen and Hathaway 1994.
std::vector<double> volume_length_qualities(const Eigen::Matrix3Xd& nodes_m, const Eigen::MatrixXi& tets);

}  // namespace soft_robot_lab
