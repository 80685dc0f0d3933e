// SPDX-License-Identifier: BSD-3-Clause
#include "execution.h"

#include <chrono>
#include <memory>
#include <stdexcept>

#include <ros/console.h>
#include <ros/init.h>

#include "conversions.h"
#include "log_text.h"
#include "marker_frames.h"

namespace soft_robot_lab {
namespace {

std::vector<double> values_of(const Eigen::VectorXd& commands) {
  return std::vector<double>(commands.data(), commands.data() + commands.size());
}

}  // namespace

ExecutePolicy::Response Execution::execute(const ExecutionOrder& order) {
  std::unique_lock lock(mutex_);
  if (run_) throw std::runtime_error("busy with another policy; ask again when it ended");
  const std::string fault = motors_.fault(order.policy.names, ros::SteadyTime::now());
  if (!fault.empty()) throw std::runtime_error(fault);
  run_.emplace(order);
  const std::shared_ptr<void> ended(nullptr, [this](void*) { run_.reset(); });
  ExecutePolicy::Response& answer = run_->answer;
  answer.final_distance_m = -1.0;
  std::string failure = wait(lock, [&] { return run_->sent && (run_->rested || !order.wait_until_rest); });
  if (failure.empty() && order.loop != nullptr) failure = correct(lock);
  answer.success = failure.empty();
  if (!failure.empty()) answer.message = failure;
  answer.duration_s = run_->elapsed_s();
  return answer;
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
  constexpr double silence_s = 10.0;  // of wall time without simulated markers
  if (!run_->fault.empty()) return run_->fault + "; the commands are held";
  if (run_->cancelled) return "cancelled";
  if (run_->elapsed_s() > run_->order.time_limit_s)
    return "not at rest within " + std::to_string(run_->order.time_limit_s) + " s";
  if (ros::isInitialized() && !ros::ok()) return "cancelled: the session ends";
  if ((ros::SteadyTime::now() - run_->heard).toSec() > silence_s) return "no markers came for 10 s";
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
    } catch (...) {
      lock.lock();
      throw;
    }
    lock.lock();
    run_->answer.final_distance_m = step.distance_m.value_or(-1.0);
    run_->answer.message = step.reason;
    if (step.end != LoopEnd::none) return step.safe() ? "" : step.reason + "; the commands are held";
    look_at_motors();
    if (measured.empty() || !problem().empty()) continue;
    send(loop.actuators(), values_of(step.commands));
    ++run_->answer.corrections;
    run_->rest = RestDetector();
    run_->rested = false;
  }
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

namespace {

// Markers that are not whole stand in the log; the next ones count.
bool are_whole(const MarkerObservations& markers) {
  try {
    require_whole(markers);
    return true;
  } catch (const std::invalid_argument& error) {
    ROS_WARN_THROTTLE(5.0, "%s", log_text(error.what()).c_str());
    return false;
  }
}

}  // namespace

void Execution::add_simulated(const MarkerObservations& markers) {
  if (!are_whole(markers)) return;
  const std::lock_guard lock(mutex_);
  if (!run_) return;
  look_at_motors();
  if (run_->cancelled || !run_->fault.empty()) return;
  if (!follow_clock(markers.header.stamp.toSec())) return;
  if (!run_->start_s) run_->start_s = run_->now_s;
  run_->heard = ros::SteadyTime::now();
  run_->answer.markers = markers;
  if (!run_->sent) {
    play();
  } else if (!run_->rested) {
    repeat();
    run_->rested = run_->rest.update(run_->now_s, raw_positions_m(markers)) && !motors_.moving();
    if (run_->rested) measured_rest_.start(run_->now_s);
  }
  changed_.notify_all();
}

void Execution::add_measured(const MarkerObservations& markers) {
  if (!are_whole(markers)) return;
  const std::lock_guard lock(mutex_);
  if (!run_) return;
  run_->answer.measured = markers;
  if (measured_rest_.add(seen_frame(markers))) run_->seen_s = run_->now_s;
  changed_.notify_all();
}

void Execution::add_motors(const MotorState& state) {
  const std::lock_guard lock(mutex_);
  motors_.add(state, ros::SteadyTime::now());
  if (!run_) return;
  look_at_motors();
  changed_.notify_all();
}

// Motors refuse commands that follow one another too fast.
void Execution::play() {
  constexpr double least_period_s = 0.01;  // of wall time
  if (motors_.known() && (ros::SteadyTime::now() - run_->commanded).toSec() < least_period_s) return;
  send(run_->player.names(), run_->player.values_at(run_->elapsed_s()));
  run_->sent = run_->elapsed_s() >= run_->player.end_s();
}

// The last command may have been refused all the same, where two were waiting for the motors' node.
void Execution::repeat() {
  constexpr double period_s = 0.2;  // less than what counts as rest
  if (motors_.known() && run_->now_s - run_->commanded_s >= period_s) send(run_->answer.names, run_->answer.values);
}

void Execution::send(const std::vector<std::string>& names, const std::vector<double>& values) {
  run_->answer.names = names;
  run_->answer.values = values;
  run_->commanded = ros::SteadyTime::now();
  run_->commanded_s = run_->now_s;
  send_(names, values);
}

// What stopped a motor once ends the run, also where it is over by now.
void Execution::look_at_motors() {
  std::vector<std::string> needed = run_->order.policy.names;
  if (run_->order.loop != nullptr)
    needed.insert(needed.end(), run_->order.loop->actuators().begin(), run_->order.loop->actuators().end());
  if (run_->fault.empty()) run_->fault = motors_.fault(needed, ros::SteadyTime::now());
}

}  // namespace soft_robot_lab
