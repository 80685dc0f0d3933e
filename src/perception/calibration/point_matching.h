// SPDX-License-Identifier: BSD-3-Clause
// Which of these points are which of those, found by their configuration alone.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace soft_robot_lab {

struct PointMatch {
  int first, second;  // columns

  bool operator==(const PointMatch& other) const { return first == other.first && second == other.second; }
};

struct PointMatching {
  std::vector<PointMatch> best;   // in the order of the first points; empty: there is none
  std::vector<PointMatch> rival;  // as many, but not the same, and as possible; empty: there is none
};

// As many points as possible, at least `min_matches`, whose mutual distances are alike within twice the tolerance and
// which a rigid motion - no mirror image - brings together within the tolerance. Throws std::invalid_argument: more
// than 16 points, min_matches below 3, a tolerance that is not positive.
PointMatching match_points(const Eigen::Matrix3Xd& first_m, const Eigen::Matrix3Xd& second_m, double tolerance_m,
                           int min_matches);

}  // namespace soft_robot_lab
