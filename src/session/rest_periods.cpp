// SPDX-License-Identifier: BSD-3-Clause
#include "rest_periods.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <sstream>

#include "same_place.h"
#include "settings/quantile.h"

namespace soft_robot_lab {
namespace {

MarkerFrame seen_frame(const ObservedMarkers& at) {
  MarkerFrame frame{at.time_s, {}};
  for (const ObservedMarker& marker : at.markers)
    if (marker.seen) frame.seen.push_back({marker.name, marker.position_m});
  return frame;
}

SeenMarkers seen_between(const Recording& recording, double start_s, double end_s, const RestCriterion& criterion) {
  const auto first = std::partition_point(recording.measured.begin(), recording.measured.end(),
                                          [&](const auto& m) { return m.time_s < start_s; });
  SeenMarkers seen;
  for (auto m = first; m != recording.measured.end() && m->time_s < end_s; ++m) add_seen(seen_frame(*m), seen);
  require_observations(criterion.observations, seen);
  return seen;
}

// Of the mean, from the scatter.
Eigen::Matrix3d covariance_of(const std::vector<Eigen::Vector3d>& all, const Eigen::Vector3d& mean) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& one : all) sum += (one - mean) * (one - mean).transpose();
  return sum / static_cast<double>(all.size() * (all.size() - 1));
}

// Means of those seen, with their covariances.
std::vector<MeasuredMarker> means_of(const SeenMarkers& seen) {
  std::vector<MeasuredMarker> markers;
  for (const auto& [name, positions] : seen) {
    const Eigen::Vector3d mean = mean_of(positions);
    markers.push_back({name, mean, covariance_of(positions, mean)});
  }
  return markers;
}

// The end of a hold, as far back as the robot was where it is at the end.
std::optional<RestPeriod> rest_at_end(const Recording& recording, const CommandsSince& commands, double end_s,
                                      const RestCriterion& criterion) {
  const auto seen = [&](double from_s, double to_s) { return seen_between(recording, from_s, to_s, criterion); };
  const SeenMarkers last = seen(end_s - criterion.window_s, end_s);
  double start_s = end_s - criterion.window_s;
  while (start_s - criterion.window_s >= commands.time_s && end_s - start_s < criterion.longest_s &&
         same_place(seen(start_s - criterion.window_s, start_s), last, criterion.measured_motion_m))
    start_s -= criterion.window_s;
  if (end_s - start_s < 1.5 * criterion.window_s) return std::nullopt;
  RestPeriod period{start_s, end_s, {commands.values, {}}};
  period.pose.markers = means_of(seen_between(recording, start_s, end_s, criterion));
  return period;
}

// Windows as long as it takes to see a marker often enough, however few frames a second there were.
RestCriterion for_frames_of(const Recording& recording, RestCriterion criterion) {
  std::vector<double> periods_s;
  for (size_t i = 1; i < recording.measured.size(); ++i)
    periods_s.push_back(recording.measured[i].time_s - recording.measured[i - 1].time_s);
  if (periods_s.empty()) return criterion;
  criterion.window_s = std::max(criterion.window_s, (criterion.observations + 0.5) * median(std::move(periods_s)));
  return criterion;
}

struct Stay {
  CommandsSince commands;
  double end_s;
};

// Where motors last stood in a hold: at its end they may have the next command already.
std::map<std::string, double> reached_in(const Recording& recording, const Stay& hold) {
  const auto after = [&](double time_s) {
    return std::partition_point(recording.reached.begin(), recording.reached.end(),
                                [time_s](const CommandsSince& one) { return one.time_s <= time_s; });
  };
  const auto end = after(hold.end_s);
  auto one = after(hold.commands.time_s);
  if (one == end && one != recording.reached.begin()) --one;  // nothing changed meanwhile
  std::map<std::string, double> values;
  for (; one != end; ++one)
    for (const auto& [name, value] : one->values) values[name] = value;
  return values;
}

// Commands that did not change for two windows at least; first the time before any.
std::vector<Stay> holds(const Recording& recording, const RestCriterion& criterion) {
  std::vector<Stay> all;
  const double first_s = recording.measured.front().time_s;
  const double last_s = recording.measured.back().time_s + 1e-6;
  std::vector<CommandsSince> since = {{first_s, {}}};
  since.insert(since.end(), recording.commands.begin(), recording.commands.end());
  for (size_t i = 0; i < since.size(); ++i) {
    const double end_s = i + 1 < since.size() ? std::min(last_s, since[i + 1].time_s) : last_s;
    if (end_s - since[i].time_s >= 2.0 * criterion.window_s) all.push_back({since[i], end_s});
  }
  return all;
}

// Numbers of the windows in which markers were tracked: between two stamps there may be years.
std::set<double> windows_in(const Recording& recording, const Stay& hold, double window_s) {
  std::set<double> windows;
  for (const ObservedMarkers& at : recording.measured) {
    const double window = std::floor((at.time_s - hold.commands.time_s) / window_s);
    if (window >= 0.0 && hold.commands.time_s + (window + 1.0) * window_s <= hold.end_s) windows.insert(window);
  }
  return windows;
}

// Window by window, in the middle of each.
std::vector<MarkersAt> seen_in(const Recording& recording, const Stay& hold, const RestCriterion& criterion) {
  std::vector<MarkersAt> all;
  const double window_s = criterion.window_s, start_s = hold.commands.time_s;
  for (const double window : windows_in(recording, hold, window_s)) {
    const double from_s = start_s + window * window_s;
    MarkersAt at{from_s + 0.5 * window_s - start_s,
                 means_of(seen_between(recording, from_s, from_s + window_s, criterion))};
    if (!at.markers.empty()) all.push_back(std::move(at));
  }
  return all;
}

constexpr double kSwing_s = 8.0;  // the drives' last way, and what is left of the swing then

// Those that cameras saw.
std::vector<MeasuredMarker> seen_markers(const ObservedMarkers& at) {
  std::vector<MeasuredMarker> seen;
  for (const ObservedMarker& marker : at.markers)
    if (marker.seen) seen.push_back({marker.name, marker.position_m, marker.covariance_m2});
  return seen;
}

// Why a hold ends without a rest.
std::string reason_without_rest(const Recording& recording, const Stay& hold, const RestCriterion& criterion) {
  std::ostringstream text;
  if (seen_between(recording, hold.end_s - criterion.window_s, hold.end_s, criterion).empty()) {
    text << "no marker was seen " << criterion.observations << " times in its last " << criterion.window_s << " s";
  } else {
    text << "in the " << hold.end_s - hold.commands.time_s << " s of it no marker came to rest within "
         << 1e3 * criterion.measured_motion_m << " mm; hold longer";
  }
  return text.str();
}

}  // namespace

std::vector<RestPeriod> rest_periods(const Recording& recording, const RestCriterion& asked) {
  std::vector<RestPeriod> periods;
  if (recording.measured.empty()) return periods;
  const RestCriterion criterion = for_frames_of(recording, asked);
  for (const Stay& hold : holds(recording, criterion))
    if (const auto period = rest_at_end(recording, hold.commands, hold.end_s, criterion)) periods.push_back(*period);
  return periods;
}

std::vector<MeasuredPose> measured_poses(const Recording& recording, const RestCriterion& asked) {
  std::vector<MeasuredPose> poses;
  if (recording.measured.empty()) return poses;
  const RestCriterion criterion = for_frames_of(recording, asked);
  for (const Stay& hold : holds(recording, criterion)) {
    const auto period = rest_at_end(recording, hold.commands, hold.end_s, criterion);
    poses.push_back(period ? period->pose : MeasuredPose{hold.commands.values, {}});
    poses.back().reached = reached_in(recording, hold);
    poses.back().held_s = hold.end_s - hold.commands.time_s;
    poses.back().rest_from_s = period ? period->start_s - hold.commands.time_s : 0.0;
    poses.back().seen = seen_in(recording, hold, criterion);
    if (poses.back().markers.empty()) poses.back().left_out = reason_without_rest(recording, hold, criterion);
  }
  return poses;
}

std::vector<MeasuredSwing> measured_swings(const Recording& recording, const RestCriterion& asked) {
  std::vector<MeasuredSwing> swings;
  if (recording.measured.empty()) return swings;
  const RestCriterion criterion = for_frames_of(recording, asked);
  const std::vector<Stay> all = holds(recording, criterion);
  for (size_t i = 1; i < all.size(); ++i) {
    const Stay &before = all[i - 1], &hold = all[i];
    if (!rest_at_end(recording, before.commands, before.end_s, criterion)) continue;
    MeasuredSwing swing{before.commands.values, {}, {}};
    for (const CommandsSince& since : recording.commands)
      if (since.time_s > before.commands.time_s && since.time_s <= hold.commands.time_s)
        swing.commands.push_back({since.time_s, {since.values.begin(), since.values.end()}});
    for (const ObservedMarkers& markers : recording.measured) {
      const double time_s = markers.time_s;
      if (time_s <= swing.commands.front().time_s || time_s > std::min(hold.end_s, hold.commands.time_s + kSwing_s))
        continue;
      MarkersAt at{time_s, seen_markers(markers)};
      if (!at.markers.empty()) swing.seen.push_back(std::move(at));
    }
    if (!swing.seen.empty()) swings.push_back(std::move(swing));
  }
  return swings;
}

}  // namespace soft_robot_lab
