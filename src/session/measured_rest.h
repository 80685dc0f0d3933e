// SPDX-License-Identifier: BSD-3-Clause
// Averages tracked markers over windows of time, and says when those that are seen have come to rest.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/control/closed_loop.h"
#include "marker_frame.h"
#include "rest_criterion.h"

namespace soft_robot_lab {

using SeenPlaces = std::vector<Eigen::Vector3d>;  // of a marker in a window, frame by frame; robot_base
using SeenMarkers = std::map<std::string, SeenPlaces>;

class MeasuredRest {
 public:
  explicit MeasuredRest(const RestCriterion& criterion = {}) : criterion_(criterion) {}

  // Forgets what it heard; observations before that time do not count.
  void start(double time_s);
  // False where none was seen.
  bool add(const MarkerFrame& frame);

  // Means of the last window, where no marker moved since the window before; of one that jumped then, the median.
  const std::optional<MeasuredMarkers>& at_rest() const { return at_rest_; }

 private:
  bool seen_enough() const;
  void end_window();

  RestCriterion criterion_;
  double start_s_ = 0.0, window_start_s_ = 0.0;
  SeenMarkers window_, before_;
  std::optional<MeasuredMarkers> at_rest_;
};

}  // namespace soft_robot_lab
