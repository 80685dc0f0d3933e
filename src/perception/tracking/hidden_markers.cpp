// SPDX-License-Identifier: BSD-3-Clause
#include "hidden_markers.h"

#include <cmath>

namespace soft_robot_lab {

HiddenEstimate estimate_hidden(int marker, const MarkerShape& last_seen, const MarkerShape& now,
                               const std::vector<double>& weights, double hidden_s, const MotionSettings& settings) {
  Eigen::Vector3d beyond_reference_m = Eigen::Vector3d::Zero();
  double sum = 0;
  for (std::size_t j = 0; j < weights.size(); ++j) {
    if (!(weights[j] > 0)) continue;
    beyond_reference_m +=
        weights[j] * ((now.believed_m[j] - last_seen.believed_m[j]) - (now.reference_m[j] - last_seen.reference_m[j]));
    sum += weights[j];
  }
  if (sum > 0) beyond_reference_m /= sum;
  HiddenEstimate estimate;
  estimate.position_m =
      last_seen.believed_m[marker] + now.reference_m[marker] - last_seen.reference_m[marker] + beyond_reference_m;
  estimate.sigma_m =
      std::hypot(settings.hidden_growth_m_s * hidden_s, settings.neighbour_ratio * beyond_reference_m.norm());
  return estimate;
}

}  // namespace soft_robot_lab
