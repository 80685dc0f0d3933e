// SPDX-License-Identifier: BSD-3-Clause
#include "live_twin.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace soft_robot_lab {
namespace {

constexpr double kArrived = 1.0e-6;  // of a command, within which a drive has reached it

}  // namespace

LiveTwin::LiveTwin(Simulation& model, const LoadEstimationOptions& options, const RestCriterion& criterion)
    : model_(model), estimator_(model, options), criterion_(criterion), rest_(criterion) {
  for (const auto& actuator : model_.actuators()) reached_.push_back(actuator->limits().rest);
}

void LiveTwin::add_drives(double time_s, const std::vector<std::string>& names, const std::vector<double>& commands,
                          const std::vector<double>& reached) {
  if (commands.size() != names.size() || reached.size() != names.size())
    throw std::invalid_argument("names, commands and actuated commands are not equally many");
  std::vector<double> now = reached_;
  bool arrived = true;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto actuator = static_cast<std::size_t>(model_.actuator_index(names[i]));
    const CommandLimits& limits = model_.actuators()[actuator]->limits();
    if (!std::isfinite(commands[i]) || !(reached[i] >= limits.min && reached[i] <= limits.max))
      throw std::invalid_argument(names[i] + ": " + std::to_string(reached[i]) + " is out of range [" +
                                  std::to_string(limits.min) + ", " + std::to_string(limits.max) + "]");
    now[actuator] = reached[i];
    arrived = arrived && std::abs(commands[i] - reached[i]) <= kArrived;
  }
  if (!arrived || now != reached_ || !arrived_) {
    rest_.start(time_s);
    window_.clear();
    judged_s_ = time_s;
  }
  arrived_ = arrived;
  reached_ = std::move(now);
}

std::vector<MeasuredMarker> LiveTwin::means() const {
  std::map<std::string, std::pair<MeasuredMarker, int>> sums;
  for (const Frame& frame : window_) {
    for (const MeasuredMarker& marker : frame.seen) {
      auto [sum, added] = sums.try_emplace(marker.name, marker, 1);
      if (added) continue;
      sum->second.first.covariance_m2 += marker.covariance_m2;
      ++sum->second.second;
    }
  }
  std::vector<MeasuredMarker> means;
  for (const auto& [name, position_m] : *rest_.at_rest()) {
    const auto sum = sums.find(name);
    if (sum == sums.end()) continue;
    // The mean of independent errors; those that stay are in the offsets.
    const double count = sum->second.second;
    means.push_back({name, position_m, sum->second.first.covariance_m2 / (count * count)});
  }
  return means;
}

std::string LiveTwin::follow_drives() {
  if (at_ == reached_) return {};
  for (std::size_t i = 0; i < reached_.size(); ++i) model_.set_command(model_.actuators()[i]->name(), reached_[i]);
  at_.reset();
  const SolveReport rest = model_.solve_equilibrium();
  if (!rest.converged) return "the model finds no rest at these commands: " + rest.message;
  at_ = reached_;
  return {};
}

std::optional<LoadEstimate> LiveTwin::add_markers(double time_s, const std::vector<MeasuredMarker>& seen) {
  if (!arrived_) return std::nullopt;
  MarkerFrame frame{time_s, {}};
  for (const MeasuredMarker& marker : seen) frame.seen.push_back({marker.name, marker.position_m});
  rest_.add(frame);
  window_.push_back({time_s, seen});
  while (!window_.empty() && window_.front().time_s < time_s - 2.0 * criterion_.window_s) window_.pop_front();
  if (!rest_.at_rest() || time_s - judged_s_ < criterion_.window_s) return std::nullopt;
  judged_s_ = time_s;
  const std::vector<MeasuredMarker> measured = means();
  if (const std::string why = follow_drives(); !why.empty()) {
    LoadEstimate result;
    result.kind = LoadKind::unknown;
    result.message = why;
    return result;
  }
  if (expect_untouched_ && !measured.empty()) {
    estimator_.take_offsets(measured);
    expect_untouched_ = false;
  }
  LoadEstimate result = estimator_.estimate(measured);
  if (result.kind == LoadKind::none) estimator_.take_offsets(measured);
  return result;
}

}  // namespace soft_robot_lab
