// SPDX-License-Identifier: BSD-3-Clause
#include "frame_joiner.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace soft_robot_lab {

FrameJoiner::FrameJoiner(const std::vector<std::string>& cameras, double sync_tolerance_s, double sync_timeout_s)
    : slop_s_(sync_tolerance_s), patience_s_(sync_timeout_s) {
  if (cameras.empty()) throw std::invalid_argument("there are no cameras to join; allowed: at least one");
  if (!(sync_tolerance_s >= 0))
    throw std::invalid_argument("sync_tolerance_s is " + std::to_string(sync_tolerance_s) + "; allowed: [0, inf)");
  if (!(sync_timeout_s >= 0))
    throw std::invalid_argument("sync_timeout_s is " + std::to_string(sync_timeout_s) + "; allowed: [0, inf)");
  for (const std::string& camera : cameras) waiting_[camera];
}

std::vector<std::vector<RgbdFrame>> FrameJoiner::add(RgbdFrame frame) {
  const auto waiting = waiting_.find(frame.camera);
  if (waiting == waiting_.end()) throw std::invalid_argument("'" + frame.camera + "' is not one of the cameras");
  const auto newest = newest_s_.find(frame.camera);
  if (newest != newest_s_.end() && frame.stamp_s <= newest->second) return {{std::move(frame)}};
  newest_s_[frame.camera] = frame.stamp_s;
  waiting->second.push_back(std::move(frame));
  std::vector<std::vector<RgbdFrame>> groups;
  for (auto oldest = oldest_s(); oldest && ready(*oldest); oldest = oldest_s()) groups.push_back(take(*oldest));
  return groups;
}

std::vector<std::vector<RgbdFrame>> FrameJoiner::finish() {
  std::vector<std::vector<RgbdFrame>> groups;
  for (auto oldest = oldest_s(); oldest; oldest = oldest_s()) groups.push_back(take(*oldest));
  return groups;
}

void FrameJoiner::reset() {
  newest_s_.clear();
  for (auto& [camera, frames] : waiting_) frames.clear();
}

std::optional<double> FrameJoiner::oldest_s() const {
  std::optional<double> oldest;
  for (const auto& [camera, frames] : waiting_)
    if (!frames.empty() && (!oldest || frames.front().stamp_s < *oldest)) oldest = frames.front().stamp_s;
  return oldest;
}

bool FrameJoiner::ready(double oldest_s) const {
  double newest = oldest_s;
  for (const auto& [camera, stamp_s] : newest_s_) newest = std::max(newest, stamp_s);
  if (newest >= oldest_s + patience_s_) return true;
  return std::none_of(waiting_.begin(), waiting_.end(), [](const auto& of_camera) { return of_camera.second.empty(); });
}

std::vector<RgbdFrame> FrameJoiner::take(double oldest_s) {
  std::vector<RgbdFrame> group;
  for (auto& [camera, frames] : waiting_) {
    if (frames.empty() || frames.front().stamp_s > oldest_s + slop_s_) continue;
    group.push_back(std::move(frames.front()));
    frames.pop_front();
  }
  return group;
}

}  // namespace soft_robot_lab
