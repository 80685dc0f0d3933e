// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "detection_fusion.h"

namespace soft_robot_lab {

// Which of one camera's sights shows which marker: the assignment of least total cost, where a pair costs the squared
// Mahalanobis distance of pixel and depth from the prediction and the logarithm of its spread (the likelihood's), and
// none beyond the gate. Sights then change places, or go to a marker without one, as long as that makes the distances
// between neighbours more like the predicted ones: silicone spans. The order of the sights means nothing. Returns the
// sight of each marker, or -1. `neighbours` lists, for each marker, markers beside it.
std::vector<int> identify(const std::vector<MarkerDetection>& sights, const std::vector<MarkerPrediction>& predictions,
                          const std::vector<std::vector<int>>& neighbours, double gate);

// The `count` nearest other markers of each, by their rest positions.
std::vector<std::vector<int>> nearest_neighbours(const std::vector<Eigen::Vector3d>& rest_positions_m, int count);

}  // namespace soft_robot_lab
