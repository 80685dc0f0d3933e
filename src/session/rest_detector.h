// SPDX-License-Identifier: BSD-3-Clause
// Finds out when simulated markers have come to rest.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "rest_criterion.h"

namespace soft_robot_lab {

class RestDetector {
 public:
  explicit RestDetector(const RestCriterion& criterion = {}) : criterion_(criterion) {}

  // Takes the next observation, in order of time; true where all markers rest.
  bool update(double time_s, const std::vector<Eigen::Vector3d>& positions_m);

 private:
  bool moved(const std::vector<Eigen::Vector3d>& positions_m) const;

  RestCriterion criterion_;
  double still_since_s_ = 0.0;
  std::vector<Eigen::Vector3d> still_positions_m_;  // where they were at that time
};

}  // namespace soft_robot_lab
