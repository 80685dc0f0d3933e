// SPDX-License-Identifier: BSD-3-Clause
#include "rest_detector.h"

namespace soft_robot_lab {

bool RestDetector::moved(const std::vector<Eigen::Vector3d>& positions_m) const {
  if (positions_m.size() != still_positions_m_.size()) return true;
  for (size_t i = 0; i < positions_m.size(); ++i)
    if (!((positions_m[i] - still_positions_m_[i]).norm() <= criterion_.simulated_motion_m)) return true;
  return false;
}

bool RestDetector::update(double time_s, const std::vector<Eigen::Vector3d>& positions_m) {
  if (positions_m.empty()) return false;
  if (moved(positions_m)) {
    still_since_s_ = time_s;
    still_positions_m_ = positions_m;
  }
  return time_s - still_since_s_ >= criterion_.window_s;
}

}  // namespace soft_robot_lab
