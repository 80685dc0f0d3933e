// SPDX-License-Identifier: BSD-3-Clause
#include "rest_detector.h"

#include <cmath>

namespace soft_robot_lab {

bool RestDetector::moved(const std::vector<geometry_msgs::Point>& positions) const {
  if (positions.size() != still_positions_.size()) return true;
  for (size_t i = 0; i < positions.size(); ++i) {
    const geometry_msgs::Point& now = positions[i];
    const geometry_msgs::Point& then = still_positions_[i];
    const double distance_m = std::hypot(now.x - then.x, now.y - then.y, now.z - then.z);
    if (!(distance_m <= criterion_.motion_m)) return true;
  }
  return false;
}

bool RestDetector::update(double time_s, const std::vector<geometry_msgs::Point>& positions) {
  if (positions.empty()) return false;
  if (moved(positions)) {
    still_since_s_ = time_s;
    still_positions_ = positions;
  }
  return time_s - still_since_s_ >= criterion_.duration_s;
}

}  // namespace soft_robot_lab
