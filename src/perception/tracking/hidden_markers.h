// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/perception/tracking/tracker_settings.h"

namespace soft_robot_lab {

// All markers at one time: where they are believed to be, and where the reference (rest shape or simulation) has them.
struct MarkerShape {
  std::vector<Eigen::Vector3d> believed_m;
  std::vector<Eigen::Vector3d> reference_m;
};

struct HiddenEstimate {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  double sigma_m = 0;  // to be added to that at the last sight
};

// Where a hidden marker is: where it was last seen, moved as its reference has moved since, and as its visible
// neighbours have moved beyond theirs, near ones counting more. `weights` are those of the other markers; all zero
// leaves the neighbours out.
HiddenEstimate estimate_hidden(int marker, const MarkerShape& last_seen, const MarkerShape& now,
                               const std::vector<double>& weights, double hidden_s, const MotionSettings& settings);

}  // namespace soft_robot_lab
