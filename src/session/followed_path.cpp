// SPDX-License-Identifier: BSD-3-Clause
#include "followed_path.h"

#include <algorithm>
#include <cmath>

namespace soft_robot_lab {

std::optional<FollowStep> FollowedPath::next(double now_s) {
  if (ended() || (asked_s_ && now_s - *asked_s_ < kFollowPeriod_s)) return std::nullopt;
  asked_s_ = now_s;
  last_ = follower_.next(now_s - start_s_, sight_, "");
  sight_.reset();
  return last_;
}

void FollowedPath::add_measured(const MarkerFrame& frame) {
  const auto seen = std::find_if(frame.seen.begin(), frame.seen.end(),
                                 [&](const SeenMarker& marker) { return marker.name == follower_.plan().marker; });
  if (seen == frame.seen.end() || frame.time_s < start_s_) return;
  if (!sight_ || frame.time_s - start_s_ > sight_->stamp_s) sight_ = {frame.time_s - start_s_, seen->position_m};
  add(frame.time_s, seen->position_m, measured_);
}

void FollowedPath::add_simulated(double stamp_s, const Eigen::Vector3d& position_m) {
  if (stamp_s >= start_s_) add(stamp_s, position_m, simulated_);
}

void FollowedPath::add(double stamp_s, const Eigen::Vector3d& position_m, Distances& distances) const {
  const double time_s = stamp_s - start_s_;
  if (!distances.track.time_s.empty() && time_s <= distances.track.time_s.back()) return;
  distances.last_m = (position_m - follower_.plan().target_at(follower_.path_at(time_s))).norm();
  distances.squares_m2 += distances.last_m * distances.last_m;
  distances.track.time_s.push_back(time_s);
  distances.track.position_m.push_back(position_m);
}

std::optional<double> FollowedPath::Distances::rms_m() const {
  if (track.time_s.empty()) return std::nullopt;
  return std::sqrt(squares_m2 / static_cast<double>(track.time_s.size()));
}

std::optional<double> FollowedPath::last_distance_m() const {
  if (!measured_.track.time_s.empty()) return measured_.last_m;
  if (!simulated_.track.time_s.empty()) return simulated_.last_m;
  return std::nullopt;
}

}  // namespace soft_robot_lab
