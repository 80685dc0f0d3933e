// SPDX-License-Identifier: BSD-3-Clause
// What a report draws of a recorded session: over time, which counts from its start, and by configuration at rest.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "ros/recording/recorded_session.h"
#include "session/report/plot.h"

namespace soft_robot_lab {

// Every so many, so that at most `count` are left.
template <typename Item>
std::vector<Item> thinned(const std::vector<Item>& all, size_t count) {
  const size_t every = (all.size() + count - 1) / count;
  std::vector<Item> some;
  for (size_t i = 0; i < all.size(); i += every) some.push_back(all[i]);
  return some;
}

// The gap over a rest period: of each marker seen in it, and of all.
struct RestGap {
  std::map<std::string, double> rms_m;
  double all_m = 0.0;
  bool known = false;
};

// Grey lines stand where events disturbed the recording.
Plot policy_plot(const RecordedSession& recording);
Plot trajectory_plot(const RecordedSession& recording, size_t axis);  // 0, 1 or 2: x, y or z
Plot gap_plot(const RecordedSession& recording);
Plot rest_plot(const std::vector<RestGap>& gaps);

}  // namespace soft_robot_lab
