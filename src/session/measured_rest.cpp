// SPDX-License-Identifier: BSD-3-Clause
#include "measured_rest.h"

#include <algorithm>

#include "same_place.h"

namespace soft_robot_lab {

void MeasuredRest::start(double time_s) {
  start_s_ = window_start_s_ = time_s;
  window_.clear();
  before_.clear();
  at_rest_.reset();
}

bool MeasuredRest::add(const MarkerFrame& frame) {
  if (frame.seen.empty()) return false;
  if (frame.time_s < start_s_) return true;
  add_seen(frame, window_);
  if (frame.time_s - window_start_s_ >= criterion_.window_s && seen_enough()) {
    end_window();
    window_start_s_ = frame.time_s;
  }
  return true;
}

// All markers; one that is seen less than half as often as another is not waited for.
bool MeasuredRest::seen_enough() const {
  const auto [least, most] = std::minmax_element(
      window_.begin(), window_.end(), [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
  const auto enough = static_cast<size_t>(criterion_.observations);
  return least->second.size() >= enough || most->second.size() >= 2 * enough;
}

void MeasuredRest::end_window() {
  require_observations(criterion_.observations, window_);
  at_rest_.reset();
  if (same_place(before_, window_, criterion_.measured_motion_m)) {
    at_rest_.emplace();
    for (const auto& [name, places_m] : window_)
      (*at_rest_)[name] = place_of(before_[name], places_m, criterion_.measured_motion_m);
  }
  before_ = std::move(window_);
  window_.clear();
}

}  // namespace soft_robot_lab
