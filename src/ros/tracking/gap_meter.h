// SPDX-License-Identifier: BSD-3-Clause
// Compares tracked markers with simulated ones at the same instant.
#pragma once

#include <deque>
#include <functional>
#include <vector>

#include <soft_robot_lab/RealityGap.h>

#include "ros/messages/messages.h"

namespace soft_robot_lab {

// The same messages give the same gaps to the last digit, in whatever order the two topics were heard.
class GapMeter {
 public:
  using OnGap = std::function<void(const RealityGap&)>;

  explicit GapMeter(OnGap on_gap) : on_gap_(std::move(on_gap)) {}

  // Each in order of time. A tracked observation is compared as soon as there are simulated ones at its stamp or on
  // both sides of it. Where the clock goes back, what was heard on that topic before is forgotten.
  void add_simulated(const MarkerObservations& markers);
  void add_measured(const MarkerObservations& markers);

 private:
  void compare();

  OnGap on_gap_;
  std::deque<MarkerObservations> simulated_, measured_;
};

// Of a whole recording; also where its session's tracker was too late for a meter.
std::vector<RealityGap> gaps_between(const std::vector<MarkerObservations>& measured,
                                     const std::vector<MarkerObservations>& simulated);

}  // namespace soft_robot_lab
