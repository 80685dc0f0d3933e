// SPDX-License-Identifier: BSD-3-Clause
// Says when markers have come to rest.
#pragma once

#include <vector>

#include <geometry_msgs/Point.h>

namespace soft_robot_lab {

struct RestCriterion {
  double motion_m = 5.0e-5;  // markers that stay within this distance
  double duration_s = 0.5;   // for this long, rest
};

class RestDetector {
 public:
  explicit RestDetector(const RestCriterion& criterion = {}) : criterion_(criterion) {}

  // Takes the next observation, in order of time; true where all markers rest.
  bool update(double time_s, const std::vector<geometry_msgs::Point>& positions);

 private:
  bool moved(const std::vector<geometry_msgs::Point>& positions) const;

  RestCriterion criterion_;
  double still_since_s_ = 0.0;
  std::vector<geometry_msgs::Point> still_positions_;  // where they were at that time
};

}  // namespace soft_robot_lab
