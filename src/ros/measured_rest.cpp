#include "soft_robot_lab/ros/measured_rest.h"

#include "soft_robot_lab/ros/conversions.h"

namespace soft_robot_lab {

bool same_place(const MeasuredMarkers& before, const MeasuredMarkers& now, double motion_m) {
  bool compared = false;
  for (const auto& [name, place_m] : now) {
    const auto then = before.find(name);
    if (then == before.end()) continue;
    if ((place_m - then->second).norm() > motion_m) return false;
    compared = true;
  }
  return compared;
}

void MeasuredRest::start(double time_s) {
  start_s_ = window_start_s_ = time_s;
  observations_ = 0;
  sums_.clear();
  before_.clear();
  at_rest_.reset();
}

bool MeasuredRest::add(const MarkerObservations& markers) {
  const double time_s = markers.header.stamp.toSec();
  bool seen = false;
  for (size_t i = 0; i < markers.names.size(); ++i) {
    if (markers.sources.at(i) != MarkerObservations::SEEN) continue;
    seen = true;
    if (time_s < start_s_) break;
    Sum& sum = sums_[markers.names[i]];
    sum.sum_m += from_message(markers.positions.at(i), "positions");
    ++sum.count;
  }
  if (!seen || time_s < start_s_) return seen;
  ++observations_;
  if (time_s - window_start_s_ >= criterion_.window_s && observations_ >= criterion_.observations) {
    end_window();
    window_start_s_ = time_s;
  }
  return true;
}

void MeasuredRest::end_window() {
  MeasuredMarkers means;
  for (const auto& [name, sum] : sums_) means[name] = sum.sum_m / sum.count;
  if (same_place(before_, means, criterion_.motion_m))
    at_rest_ = means;
  else
    at_rest_.reset();
  before_ = means;
  sums_.clear();
  observations_ = 0;
}

}  // namespace soft_robot_lab
