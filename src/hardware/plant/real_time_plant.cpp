// SPDX-License-Identifier: BSD-3-Clause
#include "real_time_plant.h"

#include <algorithm>

namespace soft_robot_lab {

void RealTimePlant::add(double time_s, std::vector<std::string> names, std::vector<double> values) {
  if (!ahead_.empty()) time_s = std::max(time_s, ahead_.back().time_s);
  ahead_.push_back({time_s, std::move(names), std::move(values)});
}

void RealTimePlant::pass_until(double time_s) {
  plant_.advance(std::max(0.0, time_s - reached_s_), {}, {});
  reached_s_ = std::max(reached_s_, time_s);
}

void RealTimePlant::follow_clock(double now_s, double latest_s) {
  if (now_s < reached_s_ - latest_s) reached_s_ = now_s;
  for (Shafts& shafts : ahead_)
    if (shafts.time_s > now_s + latest_s) shafts.time_s = now_s;
}

void RealTimePlant::advance(double now_s, double longest_s, double latest_s) {
  follow_clock(now_s, latest_s);
  const double until_s = std::min(now_s, reached_s_ + longest_s);
  while (!ahead_.empty() && ahead_.front().time_s <= until_s) {
    const Shafts shafts = std::move(ahead_.front());
    ahead_.pop_front();
    pass_until(shafts.time_s);
    plant_.advance(0.0, shafts.names, shafts.values);
  }
  pass_until(until_s);
  const double beyond_s = now_s - reached_s_ - latest_s;
  if (beyond_s <= 0.0) return;
  lost_s_ += beyond_s;
  reached_s_ += beyond_s;
}

}  // namespace soft_robot_lab
