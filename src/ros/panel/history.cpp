// SPDX-License-Identifier: BSD-3-Clause
#include "history.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace soft_robot_lab {

void History::put(const std::string& title, const std::string& name, double time_s, double value) {
  if (!std::isfinite(value)) return;
  if (time_s < now_s_ - 1.0) curves_.clear();
  now_s_ = curves_.empty() ? time_s : std::max(now_s_, time_s);
  Points& points = curves_[title][name];
  if (!points.empty() && time_s < points.back().first + period_s) return;
  points.emplace_back(time_s, value);
  while (points.front().first < time_s - kept_s) points.pop_front();
}

void History::add(const MarkerObservations& markers, const std::string& marker) {
  const auto found = std::find(markers.names.begin(), markers.names.end(), marker);
  const auto index = static_cast<std::size_t>(found - markers.names.begin());
  if (index >= markers.positions.size()) return;
  const geometry_msgs::Point& at = markers.positions[index];
  const std::vector<double> position_m = {at.x, at.y, at.z};
  if (marker != marker_) {
    curves_.erase(marker_ + " [mm]");
    start_m_ = position_m;
    marker_ = marker;
  }
  for (std::size_t axis = 0; axis < 3; ++axis)
    put(marker + " [mm]", std::string(1, "xyz"[axis]), markers.header.stamp.toSec(),
        1e3 * (position_m[axis] - start_m_[axis]));
}

void History::add(const ActuatorState& actuators) {
  const double time_s = actuators.header.stamp.toSec();
  for (const CableState& cable : actuators.cables) put("tension [N]", cable.name, time_s, cable.tension_n);
  for (const ChamberState& chamber : actuators.chambers)
    put("pressure [kPa]", chamber.name, time_s, 1e-3 * chamber.gauge_pressure_pa);
}

void History::add(const RealityGap& gap) { put("gap [mm]", "rms", gap.header.stamp.toSec(), 1e3 * gap.rms_m); }

std::vector<std::string> History::titles() const {
  std::vector<std::string> titles;
  for (const auto& [title, curves] : curves_) titles.push_back(title);
  return titles;
}

const History::Curves& History::curves(const std::string& title) const {
  static const Curves none;
  const auto found = curves_.find(title);
  return found == curves_.end() ? none : found->second;
}

std::pair<double, double> History::range(const std::string& title) const {
  double least = std::numeric_limits<double>::infinity(), greatest = -least;
  for (const auto& [name, points] : curves(title))
    for (const auto& [time_s, value] : points) {
      least = std::min(least, value);
      greatest = std::max(greatest, value);
    }
  if (!(least <= greatest)) least = greatest = 0.0;
  const bool length = title.size() > 4 && title.compare(title.size() - 4, 4, "[mm]") == 0;
  const double missing = (length ? 1.0 : 0.1) - (greatest - least);
  if (missing <= 0.0) return {least, greatest};
  return {least - 0.5 * missing, greatest + 0.5 * missing};
}

}  // namespace soft_robot_lab
