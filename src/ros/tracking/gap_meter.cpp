// SPDX-License-Identifier: BSD-3-Clause
#include "gap_meter.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>

#include "ros/messages/conversions.h"
#include "ros/base/stamps.h"

namespace soft_robot_lab {
namespace {

constexpr double kept_markers_s = 5.0;  // of simulated markers: longer than a tracker takes
using Places = std::map<std::string, Eigen::Vector3d>;

Places places_of(const MarkerObservations& markers) {
  Places places;
  for (size_t i = 0; i < markers.names.size(); ++i)
    places[markers.names[i]] = from_message(markers.positions.at(i), "positions");
  return places;
}

Places between(const MarkerObservations& before, const MarkerObservations& after, const ros::Time& stamp) {
  Places places = places_of(before);
  if (stamp == before.header.stamp) return places;
  const double fraction =
      seconds_between(before.header.stamp, stamp) / seconds_between(before.header.stamp, after.header.stamp);
  const Places then = places_of(after);
  for (auto& [name, position_m] : places)
    if (const auto found = then.find(name); found != then.end()) position_m += fraction * (found->second - position_m);
  return places;
}

// A clock that goes back begins anew. Throws std::invalid_argument for what could not be compared.
void add(const MarkerObservations& markers, std::deque<MarkerObservations>& queue) {
  require_whole(markers);
  if (!queue.empty() && markers.header.stamp < queue.back().header.stamp) queue.clear();
  queue.push_back(markers);
}

// Absent where no marker that is simulated was seen.
std::optional<RealityGap> gap_of(const MarkerObservations& measured, const Places& simulated) {
  RealityGap gap;
  gap.header = measured.header;
  double sum_m2 = 0.0;
  int seen = 0;
  for (size_t i = 0; i < measured.names.size(); ++i) {
    const auto place = simulated.find(measured.names[i]);
    if (place == simulated.end()) continue;
    const Eigen::Vector3d gap_m = from_message(measured.positions.at(i), "positions") - place->second;
    gap.names.push_back(measured.names[i]);
    gap.measured.push_back(measured.positions[i]);
    gap.gaps.emplace_back();
    gap.gaps.back().x = gap_m.x();
    gap.gaps.back().y = gap_m.y();
    gap.gaps.back().z = gap_m.z();
    gap.distances_m.push_back(gap_m.norm());
    gap.seen.push_back(measured.sources.at(i) == MarkerObservations::SEEN);
    if (gap.seen.back() == 0) continue;
    sum_m2 += gap_m.squaredNorm();
    ++seen;
  }
  if (seen == 0) return std::nullopt;
  gap.rms_m = std::sqrt(sum_m2 / seen);
  return gap;
}

}  // namespace

void GapMeter::add_simulated(const MarkerObservations& markers) {
  add(markers, simulated_);
  while (seconds_between(simulated_.front().header.stamp, markers.header.stamp) > kept_markers_s)
    simulated_.pop_front();
  compare();
}

void GapMeter::add_measured(const MarkerObservations& markers) {
  add(markers, measured_);
  compare();
}

std::vector<RealityGap> gaps_between(const std::vector<MarkerObservations>& measured,
                                     const std::vector<MarkerObservations>& simulated) {
  std::vector<RealityGap> gaps;
  GapMeter meter([&](const RealityGap& gap) { gaps.push_back(gap); });
  for (const MarkerObservations& markers : measured) meter.add_measured(markers);
  for (const MarkerObservations& markers : simulated) meter.add_simulated(markers);
  return gaps;
}

void GapMeter::compare() {
  const auto later = [](const MarkerObservations& markers, const ros::Time& stamp) {
    return markers.header.stamp < stamp;
  };
  while (!measured_.empty()) {
    const ros::Time stamp = measured_.front().header.stamp;
    const auto after = std::lower_bound(simulated_.begin(), simulated_.end(), stamp, later);
    if (after == simulated_.end()) return;
    const bool known = after->header.stamp == stamp || after != simulated_.begin();
    if (known) {
      const auto& before = after->header.stamp == stamp ? *after : *std::prev(after);
      if (const auto gap = gap_of(measured_.front(), between(before, *after, stamp))) on_gap_(*gap);
    }
    measured_.pop_front();
  }
}

}  // namespace soft_robot_lab
