#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "soft_robot_lab/ros/conversions.h"
#include "soft_robot_lab/ros/recording.h"

namespace soft_robot_lab {
namespace {

using Positions = std::map<std::string, std::vector<Eigen::Vector3d>>;  // seen, by marker

// Of markers seen often enough to know their means and scatter.
Positions seen_between(const Recording& recording, double start_s, double end_s, const RestCriteria& criteria) {
  const auto first = std::partition_point(recording.measured.begin(), recording.measured.end(),
                                          [&](const auto& m) { return m.header.stamp.toSec() < start_s; });
  Positions seen;
  for (auto m = first; m != recording.measured.end() && m->header.stamp.toSec() < end_s; ++m)
    for (size_t i = 0; i < m->names.size(); ++i)
      if (m->sources[i] == MarkerObservations::SEEN)
        seen[m->names[i]].push_back(from_message(m->positions[i], "positions"));
  for (auto marker = seen.begin(); marker != seen.end();) {
    const bool enough = marker->second.size() >= static_cast<size_t>(criteria.observations);
    marker = enough ? std::next(marker) : seen.erase(marker);
  }
  return seen;
}

Eigen::Vector3d mean_of(const std::vector<Eigen::Vector3d>& all) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& one : all) sum += one;
  return sum / static_cast<double>(all.size());
}

// Of the mean, from the scatter.
Eigen::Matrix3d covariance_of(const std::vector<Eigen::Vector3d>& all, const Eigen::Vector3d& mean) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& one : all) sum += (one - mean) * (one - mean).transpose();
  return sum / static_cast<double>(all.size() * (all.size() - 1));
}

// Coordinate by coordinate: of a few frames, one that missed says nothing about motion.
Eigen::Vector3d median_of(const std::vector<Eigen::Vector3d>& all) {
  Eigen::Vector3d median;
  std::vector<double> sorted(all.size());
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::transform(all.begin(), all.end(), sorted.begin(), [axis](const Eigen::Vector3d& one) { return one[axis]; });
    std::sort(sorted.begin(), sorted.end());
    median[axis] = 0.5 * (sorted[(sorted.size() - 1) / 2] + sorted[sorted.size() / 2]);
  }
  return median;
}

// Of a frame's position, from second differences, which no steady motion changes; all axes together.
double noise_of(const std::vector<Eigen::Vector3d>& all) {
  double sum_m2 = 0.0;
  for (size_t i = 2; i < all.size(); ++i) sum_m2 += (all[i] - 2.0 * all[i - 1] + all[i - 2]).squaredNorm() / 6.0;
  return all.size() < 3 ? 0.0 : std::sqrt(sum_m2 / static_cast<double>(all.size() - 2));
}

// Whether no marker moved farther than it may, or than its noise would have it.
bool same_place(const Positions& before, const Positions& now, double motion_m) {
  constexpr double of_median = 1.25, deviations = 3.0;
  bool compared = false;
  for (const auto& [name, late] : now) {
    const auto early = before.find(name);
    if (early == before.end()) continue;
    std::vector<Eigen::Vector3d> all = early->second;
    all.insert(all.end(), late.begin(), late.end());
    const double frames =
        1.0 / (1.0 / static_cast<double>(early->second.size()) + 1.0 / static_cast<double>(late.size()));
    const double noise_m = deviations * of_median * noise_of(all) / std::sqrt(frames);
    if ((median_of(late) - median_of(early->second)).norm() > motion_m + noise_m) return false;
    compared = true;
  }
  return compared;
}

// The end of a hold, as far back as the robot was where it is at the end.
std::optional<RestPeriod> rest_at_end(const Recording& recording, const CommandsSince& commands, double end_s,
                                      const RestCriteria& criteria) {
  const auto seen = [&](double from_s, double to_s) { return seen_between(recording, from_s, to_s, criteria); };
  const Positions last = seen(end_s - criteria.window_s, end_s);
  double start_s = end_s - criteria.window_s;
  while (start_s - criteria.window_s >= commands.time_s && end_s - start_s < criteria.longest_s &&
         same_place(seen(start_s - criteria.window_s, start_s), last, criteria.motion_m))
    start_s -= criteria.window_s;
  if (end_s - start_s < 1.5 * criteria.window_s) return std::nullopt;
  RestPeriod period{start_s, end_s, {commands.values, {}}};
  for (const auto& [name, positions] : seen_between(recording, start_s, end_s, criteria)) {
    const Eigen::Vector3d mean = mean_of(positions);
    period.pose.markers.push_back({name, mean, covariance_of(positions, mean)});
  }
  return period;
}

// Windows as long as it takes to see a marker often enough, however few frames a second there were.
RestCriteria for_frames_of(const Recording& recording, RestCriteria criteria) {
  std::vector<double> periods_s;
  for (size_t i = 1; i < recording.measured.size(); ++i)
    periods_s.push_back((recording.measured[i].header.stamp - recording.measured[i - 1].header.stamp).toSec());
  if (periods_s.empty()) return criteria;
  const auto median = periods_s.begin() + static_cast<std::ptrdiff_t>(periods_s.size() / 2);
  std::nth_element(periods_s.begin(), median, periods_s.end());
  criteria.window_s = std::max(criteria.window_s, (criteria.observations + 0.5) * *median);
  return criteria;
}

struct Hold {
  CommandsSince commands;
  double end_s;
};

// Where motors last stood in a hold: at its end they may be told of the next one already.
std::map<std::string, double> reached_in(const Recording& recording, const Hold& hold) {
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
std::vector<Hold> holds(const Recording& recording, const RestCriteria& criteria) {
  std::vector<Hold> all;
  const double first_s = recording.measured.front().header.stamp.toSec();
  const double last_s = recording.measured.back().header.stamp.toSec() + 1e-6;
  std::vector<CommandsSince> since = {{first_s, {}}};
  since.insert(since.end(), recording.commands.begin(), recording.commands.end());
  for (size_t i = 0; i < since.size(); ++i) {
    const double end_s = i + 1 < since.size() ? std::min(last_s, since[i + 1].time_s) : last_s;
    if (end_s - since[i].time_s >= 2.0 * criteria.window_s) all.push_back({since[i], end_s});
  }
  return all;
}

}  // namespace

std::vector<RestPeriod> rest_periods(const Recording& recording, const RestCriteria& asked) {
  std::vector<RestPeriod> periods;
  if (recording.measured.empty()) return periods;
  const RestCriteria criteria = for_frames_of(recording, asked);
  for (const Hold& hold : holds(recording, criteria))
    if (const auto period = rest_at_end(recording, hold.commands, hold.end_s, criteria)) periods.push_back(*period);
  return periods;
}

std::vector<MeasuredPose> measured_poses(const Recording& recording, const RestCriteria& asked) {
  std::vector<MeasuredPose> poses;
  if (recording.measured.empty()) return poses;
  const RestCriteria criteria = for_frames_of(recording, asked);
  for (const Hold& hold : holds(recording, criteria)) {
    const auto period = rest_at_end(recording, hold.commands, hold.end_s, criteria);
    poses.push_back(period ? period->pose : MeasuredPose{hold.commands.values, {}});
    poses.back().reached = reached_in(recording, hold);
  }
  return poses;
}

}  // namespace soft_robot_lab
