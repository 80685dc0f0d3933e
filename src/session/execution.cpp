// SPDX-License-Identifier: BSD-3-Clause
#include "execution.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "soft_robot_lab/control/forward_model.h"

namespace soft_robot_lab {
namespace {

std::vector<double> values_of(const Eigen::VectorXd& commands) {
  return std::vector<double>(commands.data(), commands.data() + commands.size());
}

bool holds(const std::string& name, double value, const std::vector<std::string>& names,
           const std::vector<double>& values) {
  const auto at = static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  return at < values.size() && std::abs(values[at] - value) <= 1e-9 * std::max(1.0, std::abs(value));
}

// Whether each of `asked` stands with its value among `names`; never where nothing was asked.
bool holds_all(const std::vector<std::string>& asked, const std::vector<double>& asked_values,
               const std::vector<std::string>& names, const std::vector<double>& values) {
  for (std::size_t i = 0; i < asked.size(); ++i)
    if (!holds(asked[i], asked_values[i], names, values)) return false;
  return !asked.empty();
}

}  // namespace

ExecutionReport Execution::execute(const ExecutionOrder& order) {
  std::unique_lock lock(mutex_);
  if (run_) throw std::runtime_error("busy with another policy; ask again when it ended");
  const std::string fault = motors_.fault(order.policy.names, host_.machine_time_s());
  if (!fault.empty()) throw std::runtime_error(fault);
  run_.emplace(order, host_.machine_time_s());
  const std::shared_ptr<void> ended(nullptr, [this](void*) { run_.reset(); });
  ExecutionReport& report = run_->report;
  std::string failure = wait(lock, [&] { return run_->sent && (run_->rested || !order.wait_until_rest); });
  if (failure.empty() && order.loop != nullptr) failure = correct(lock);
  if (failure.empty() && order.follower != nullptr) failure = follow(lock);
  report.success = failure.empty();
  if (!failure.empty()) report.message = failure;
  report.duration_s = run_->elapsed_s();
  return report;
}

std::string Execution::wait(std::unique_lock<std::mutex>& lock, const std::function<bool()>& reached) {
  while (true) {
    look_at_motors();
    if (std::string what = problem(); !what.empty()) return what;
    if (reached()) return "";
    changed_.wait_for(lock, std::chrono::milliseconds(100));
  }
}

std::string Execution::problem() const {
  constexpr double silence_s = 10.0;  // of the machine's time without simulated markers
  if (!run_->fault.empty()) return run_->fault + "; the commands are held";
  if (run_->cancelled) return "cancelled";
  if (run_->elapsed_s() > run_->order.time_limit_s && run_->sent && drives_report_ && !run_->heard)
    return "the simulator has not heard the last command within " + std::to_string(run_->order.time_limit_s) + " s";
  if (run_->elapsed_s() > run_->order.time_limit_s)
    return (followed_ ? "not at the path's end within " : "not at rest within ") +
           std::to_string(run_->order.time_limit_s) + " s";
  if (host_.ends()) return "cancelled: the session ends";
  if (host_.machine_time_s() - run_->heard_at_s > silence_s) return "no markers came for 10 s";
  return "";
}

// The loop is asked while nothing is locked: it takes its time.
std::string Execution::correct(std::unique_lock<std::mutex>& lock) {
  ClosedLoop& loop = *run_->order.loop;
  double asked_s = run_->now_s;
  run_->seen_s = run_->now_s;
  measured_rest_.start(run_->now_s);
  while (true) {
    if (std::string what = wait(lock, [&] { return may_correct(asked_s); }); !what.empty()) return what;
    asked_s = run_->now_s;
    const MeasuredMarkers measured = measured_rest_.at_rest().value_or(MeasuredMarkers());
    lock.unlock();
    LoopStep step;
    try {
      step = loop.correct(asked_s, measured, "");
    } catch (const ForwardModelInterrupted&) {
      lock.lock();
      return "cancelled";
    } catch (...) {
      lock.lock();
      throw;
    }
    lock.lock();
    run_->report.final_distance_m = step.distance_m.value_or(-1.0);
    run_->report.message = step.reason;
    if (step.end != LoopEnd::none) return step.safe() ? "" : step.reason + "; the commands are held";
    look_at_motors();
    if (measured.empty() || !problem().empty()) continue;
    send(loop.actuators(), values_of(step.commands));
    ++run_->report.corrections;
    run_->rest = RestDetector();
    run_->rested = false;
  }
}

std::string Execution::follow(std::unique_lock<std::mutex>& lock) {
  followed_.emplace(*run_->order.follower, run_->now_s);
  const std::shared_ptr<void> ended(nullptr, [this](void*) { followed_.reset(); });
  std::string failure = wait(lock, [this] { return followed_->ended(); });
  run_->report.measured_path_rms_m = followed_->measured_rms_m();
  run_->report.simulated_path_rms_m = followed_->simulated_rms_m();
  run_->report.measured_path = followed_->measured();
  if (failure.empty() && followed_->last().end != PathEnd::done)
    failure = followed_->last().reason + "; the commands are held";
  return failure;
}

// Markers at rest, or none for so long that the loop has to know.
bool Execution::may_correct(double after_s) const {
  if (!(run_->now_s > after_s) || !run_->rested || motors_.moving()) return false;
  return measured_rest_.at_rest() || run_->now_s - run_->seen_s >= loop_options_.lost_after_s;
}

bool Execution::running() const {
  const std::lock_guard lock(mutex_);
  return run_.has_value();
}

bool Execution::has_motors() const {
  const std::lock_guard lock(mutex_);
  return motors_.known();
}

bool Execution::cancel() {
  const std::lock_guard lock(mutex_);
  if (run_) run_->cancelled = true;
  changed_.notify_all();
  return run_.has_value();
}

// A policy is played by the session's time: where that jumps, nothing it would do next was meant.
bool Execution::follow_clock(double stamp_s) {
  constexpr double longest_back_s = 1.0, longest_ahead_s = 3600.0;  // of messages that a busy machine loses
  const double step_s = stamp_s - run_->now_s;
  if (run_->start_s && (step_s < -longest_back_s || step_s > longest_ahead_s)) {
    run_->fault = "the clock was set by " + std::to_string(step_s) + " s";
    changed_.notify_all();
    return false;
  }
  run_->now_s = stamp_s;
  return true;
}

void Execution::add_simulated(double stamp_s, const std::vector<Eigen::Vector3d>& positions_m) {
  const std::lock_guard lock(mutex_);
  if (!run_) return;
  look_at_motors();
  if (run_->cancelled || !run_->fault.empty()) return;
  if (!follow_clock(stamp_s)) return;
  if (!run_->start_s) run_->start_s = run_->now_s;
  run_->heard_at_s = host_.machine_time_s();
  run_->report.simulated_s = stamp_s;
  if (!run_->sent) {
    play();
  } else if (followed_) {
    go_on_along_path(positions_m);
  } else if (!run_->rested) {
    repeat();
    if (drives_report_ && !run_->heard) run_->rest = RestDetector();
    run_->rested = run_->rest.update(run_->now_s, positions_m) && !motors_.moving();
    if (run_->rested) measured_rest_.start(run_->now_s);
  }
  changed_.notify_all();
}

void Execution::add_measured(const MarkerFrame& frame) {
  const std::lock_guard lock(mutex_);
  if (!run_) return;
  run_->report.measured_s = frame.time_s;
  if (followed_) followed_->add_measured(frame);
  if (measured_rest_.add(frame)) run_->seen_s = run_->now_s;
  changed_.notify_all();
}

void Execution::add_motors(MotorWatchReport report) {
  const std::lock_guard lock(mutex_);
  motors_.add(std::move(report), host_.machine_time_s());
  if (!run_) return;
  look_at_motors();
  changed_.notify_all();
}

void Execution::add_drives(const std::vector<std::string>& names, const std::vector<double>& commands) {
  const std::lock_guard lock(mutex_);
  drives_report_ = true;
  if (!run_ || run_->heard) return;
  run_->heard = holds_all(run_->report.names, run_->report.values, names, commands);
}

// Motors refuse commands that follow one another too fast.
bool Execution::too_early_for_motors() const {
  constexpr double least_period_s = 0.01;  // of the machine's time
  return motors_.known() && host_.machine_time_s() - run_->commanded_at_s < least_period_s;
}

void Execution::play() {
  if (too_early_for_motors()) return;
  send(run_->player.names(), run_->player.values_at(run_->elapsed_s()));
  run_->sent = run_->elapsed_s() >= run_->player.end_s();
}

void Execution::go_on_along_path(const std::vector<Eigen::Vector3d>& positions_m) {
  if (run_->order.followed_marker < positions_m.size())
    followed_->add_simulated(run_->now_s, positions_m[run_->order.followed_marker]);
  if (too_early_for_motors()) return;
  const std::optional<FollowStep> step = followed_->next(run_->now_s);
  if (!step || !(step->end == PathEnd::none || step->end == PathEnd::done)) return;
  std::vector<std::string> names;
  for (const PathDrive& drive : run_->order.follower->plan().drives) names.push_back(drive.actuator);
  send(names, values_of(step->commands));
  if (run_->order.on_path) run_->order.on_path(step->path_s, followed_->last_distance_m());
}

// The last command may have been refused all the same, where two were waiting for the motors' node.
void Execution::repeat() {
  constexpr double period_s = 0.2;  // less than what counts as rest
  if (motors_.known() && run_->now_s - run_->commanded_s >= period_s) send(run_->report.names, run_->report.values);
}

void Execution::send(const std::vector<std::string>& names, const std::vector<double>& values) {
  run_->heard = run_->heard && names == run_->report.names && values == run_->report.values;
  run_->report.names = names;
  run_->report.values = values;
  run_->commanded_at_s = host_.machine_time_s();
  run_->commanded_s = run_->now_s;
  host_.send(names, values);
}

// What stopped a motor once ends the run, also where it is over by now.
void Execution::look_at_motors() {
  std::vector<std::string> needed = run_->order.policy.names;
  if (run_->order.loop != nullptr)
    needed.insert(needed.end(), run_->order.loop->actuators().begin(), run_->order.loop->actuators().end());
  if (run_->fault.empty()) run_->fault = motors_.fault(needed, host_.machine_time_s());
}

}  // namespace soft_robot_lab
