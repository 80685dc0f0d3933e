// SPDX-License-Identifier: BSD-3-Clause
#include "path_follower.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "control/refuse.h"

namespace soft_robot_lab {
namespace {

constexpr double kRemembered_s = 5.0;  // no frame is later
constexpr double kSameTime_s = 1.0e-6;

}  // namespace

void FollowOptions::validate() const {
  if (!(gain > 0.0 && gain <= 1.0)) refuse("gain: ", gain, " is not in (0, 1]");
  if (!(damping > 0.0 && damping <= 1.0)) refuse("damping: ", damping, " is not in (0, 1]");
  if (!(drive_lag_s >= 0.0 && drive_lag_s <= 1.0)) refuse("drive_lag_s: ", drive_lag_s, " is not in [0, 1]");
  if (!(lead_s >= 0.0 && lead_s <= 1.0)) refuse("lead_s: ", lead_s, " is not in [0, 1]");
  if (!(hold_after_s > 0.0 && std::isfinite(hold_after_s)))
    refuse("hold_after_s: ", hold_after_s, " is not in (0, inf)");
  if (!(lost_after_s > hold_after_s && std::isfinite(lost_after_s)))
    refuse("lost_after_s: ", lost_after_s, " is not in (", hold_after_s, ", inf)");
  if (!(largest_error_m > 0.0)) refuse("largest_error_m: ", largest_error_m, " is not in (0, inf]");
}

PathFollower::PathFollower(PathPlan plan, const FollowOptions& options)
    : plan_(std::move(plan)),
      options_(options),
      damping_m_(options.damping * plan_.largest_jacobian_m()),
      play_(plan_.drives) {
  options.validate();
  if (!plan_.complete) refuse("the plan is not complete: ", plan_.message);
  wanted_ = plan_.samples.front().commands;
  last_.commands = play_.go(wanted_);
}

FollowStep PathFollower::stop(PathEnd end, const std::string& reason) {
  last_.end = end;
  last_.reason = reason;
  return last_;
}

PathFollower::Sent PathFollower::sent_at(double time_s) const {
  const auto after = std::upper_bound(sent_.begin(), sent_.end(), time_s + kSameTime_s,
                                      [](double time, const Sent& sent) { return time < sent.time_s; });
  return after == sent_.begin() ? sent_.front() : *(after - 1);
}

// Since the last command the path has gone on, unless it waits for the marker.
double PathFollower::path_at(double time_s) const {
  if (sent_.empty()) return 0.0;
  const Sent then = sent_at(time_s);
  const double gone_s = std::max(0.0, time_s - then.time_s);
  const bool newest = then.time_s == sent_.back().time_s;
  return then.path_s + (newest ? (last_.holding ? 0.0 : gone_s) : std::min(gone_s, path_s_ - then.path_s));
}

void PathFollower::take_up(const StampedMarker& seen) {
  if (sent_.empty() || !seen.position_m.allFinite() || !std::isfinite(seen.stamp_s)) return;
  const Sent through = sent_at(seen.stamp_s - options_.drive_lag_s);
  const double path_s = path_at(seen.stamp_s);
  const Eigen::Vector3d expected_m = plan_.predicted_at(path_s) + plan_.jacobian_at(path_s) * through.correction;
  disturbance_m_ += options_.gain * (seen.position_m - expected_m - disturbance_m_);
  missed_m_ = (seen.position_m - plan_.target_at(path_s)).norm();
  last_sight_s_ = std::max(last_sight_s_.value_or(seen.stamp_s), seen.stamp_s);
}

bool PathFollower::is_lost(double time_s, FollowStep& step) {
  if (!options_.feedback) return false;
  const double unseen_s = time_s - last_sight_s_.value_or(*start_s_);
  step.holding = unseen_s > options_.hold_after_s;
  return unseen_s > options_.lost_after_s;
}

Eigen::VectorXd PathFollower::wanted_commands(double path_s, double passed_s) {
  Eigen::VectorXd wanted = plan_.commands_at(path_s + options_.lead_s);
  if (options_.feedback)
    wanted -= damped_inverse(plan_.jacobian_at(path_s + options_.lead_s), disturbance_m_, damping_m_);
  for (std::size_t i = 0; i < plan_.drives.size(); ++i) {
    const PathDrive& drive = plan_.drives[i];
    double& one = wanted[static_cast<Eigen::Index>(i)];
    const double before = wanted_[static_cast<Eigen::Index>(i)], reach = drive.max_rate_per_s * passed_s;
    one = std::clamp(std::clamp(one, before - reach, before + reach), drive.min, drive.max);
  }
  return wanted;
}

FollowStep PathFollower::next(double time_s, const std::optional<StampedMarker>& seen, const std::string& fault) {
  if (last_.end != PathEnd::none) return last_;
  if (!start_s_) start_s_ = time_s;
  const double passed_s = time_s - last_s_.value_or(time_s);
  if (!(passed_s >= 0.0)) refuse("time_s: ", time_s, " is before the last one");
  last_s_ = time_s;
  if (!fault.empty()) return stop(PathEnd::fault, "the drives have a fault: " + fault);
  if (seen && options_.feedback) take_up(*seen);
  FollowStep step;
  if (is_lost(time_s, step))
    return stop(PathEnd::marker_lost,
                "marker '" + plan_.marker + "' was not seen for " + std::to_string(options_.lost_after_s) + " s");
  if (options_.feedback && missed_m_ > options_.largest_error_m) {
    std::ostringstream text;
    text << "marker '" << plan_.marker << "' is " << 1e3 * missed_m_ << " mm from its path";
    return stop(PathEnd::error_too_large, text.str());
  }
  if (step.holding) {
    step.path_s = path_s_;
    step.commands = last_.commands;
    sent_.push_back({time_s, path_s_, sent_.empty() ? Eigen::VectorXd::Zero(wanted_.size()) : sent_.back().correction});
    return last_ = step;
  }
  path_s_ = std::min(plan_.duration_s(), path_s_ + passed_s);
  wanted_ = wanted_commands(path_s_, passed_s);
  sent_.push_back({time_s, path_s_, wanted_ - plan_.commands_at(path_s_ + options_.lead_s)});
  while (sent_.size() > 1 && sent_.front().time_s < time_s - kRemembered_s) sent_.pop_front();
  step.path_s = path_s_;
  step.commands = play_.go(wanted_);
  if (path_s_ >= plan_.duration_s()) step.end = PathEnd::done;
  return last_ = step;
}

}  // namespace soft_robot_lab
