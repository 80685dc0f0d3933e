// SPDX-License-Identifier: BSD-3-Clause
#include "motor_driver.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "words.h"

namespace soft_robot_lab {
namespace {

constexpr double emergency_period_s = 0.02;

template <typename Targets>
std::set<std::int64_t> commands_in(const Targets& targets) {
  std::set<std::int64_t> commands;
  for (const auto& target : targets) {
    if (target) commands.insert(target->command);
  }
  return commands;
}

constexpr double kLostBeforeWatchdog = 0.6;  // of its time: both ends then agree that the link is lost

LinkOptions link_options(const RigSettings& rig, const DriverOptions& options) {
  LinkOptions link;
  link.lost_s = kLostBeforeWatchdog * rig.watchdog_s;
  link.first_session = options.first_session;
  return link;
}

}  // namespace

MotorDriver::MotorDriver(RigSettings rig, DriverOptions options, OpenPort open_port)
    : rig_(std::move(rig)),
      options_(options),
      link_(link_options(rig_, options), configuration_crc(rig_), std::move(open_port)),
      zero_at_start_due_(options.zero_at_start) {}

void MotorDriver::update(double now_s) {
  for (const LinkEvent& event : link_.update(now_s)) {
    std::visit([this](const auto& event_of_kind) { on(event_of_kind); }, event);
  }
  const bool clearing = operation_ == OperationState::running && !steps_.empty() && steps_[0].kind == wire::kind_clear;
  if (emergency_stopped_ && !clearing && now_s - emergency_sent_s_ >= emergency_period_s) {
    const bool heard = std::all_of(
        motors_.begin(), motors_.begin() + static_cast<std::ptrdiff_t>(rig_.motors.size()),
        [](const Motor& motor) { return motor.report && (motor.report->flags & wire::flag_emergency_stop) != 0; });
    if (!heard) link_.emergency_stop();
    emergency_sent_s_ = now_s;
  }
  if (zero_at_start_due_ && ready()) {
    zero_at_start_due_ = false;
    std::uint8_t mask = 0;
    for (std::size_t i = 0; i < rig_.motors.size(); ++i) {
      if ((motors_[i].report->flags & wire::flag_power_up) != 0) mask = static_cast<std::uint8_t>(mask | 1U << i);
    }
    if (mask != 0) steps_.push_back({wire::kind_zero, {mask}, false});
  }
  send_next(now_s);
}

bool MotorDriver::ready() const {
  return link_.open() && configured_ &&
         std::all_of(motors_.begin(), motors_.begin() + static_cast<std::ptrdiff_t>(rig_.motors.size()),
                     [](const Motor& motor) { return motor.report.has_value(); });
}

// ---- what the link reports

void MotorDriver::on(const LinkOpened& event) {
  for (Motor& motor : motors_) motor.report.reset();
  steps_.clear();
  step_sent_ = false;
  configured_ = event.same_configuration;
  link_failure_.clear();
  if (event.motor_count != static_cast<int>(rig_.motors.size())) {
    configured_ = false;
    link_failure_ = "the board found " + std::to_string(event.motor_count) + " motor drivers, the rig's file lists " +
                    std::to_string(rig_.motors.size());
  } else if (!configured_) {
    configure();
  }
}

void MotorDriver::on(const LinkLost& event) {
  link_failure_ = event.reason;
  configured_ = false;
  steps_.clear();
  step_sent_ = false;
  refuse_targets(waiting_, "the link was lost: " + event.reason);
  fail_operation("the link was lost: " + event.reason);
}

void MotorDriver::on(const RequestAnswered& event) {
  const bool done = event.result == wire::result_done;
  if (event.kind == wire::kind_go_to) {
    if (done) {
      take_on_targets();
    } else {
      refuse_targets(sent_, words(event.result));
    }
    return;
  }
  if (!step_sent_ || steps_.empty() || steps_[0].kind != event.kind) return;
  step_sent_ = false;
  const bool configuring = event.kind == wire::kind_configure_board || event.kind == wire::kind_configure_motor;
  if (configuring && event.result == wire::result_moving) return;  // motors still slow down: once more
  const Step step = steps_[0];
  steps_.pop_front();
  if (configuring) end_configuring(event.result);
  if (step.kind == wire::kind_zero && done) zero_spools(step.payload[0]);
  // An emergency stop since then has failed the operation, and holds.
  if (step.kind == wire::kind_clear && done && operation_ == OperationState::running) emergency_stopped_ = false;
  if (step.operation) finish(done, words(event.result));
}

// Of the board, or of one motor.
void MotorDriver::end_configuring(wire::Result result) {
  if (result != wire::result_done) {
    link_failure_ = "the board refused its configuration: " + words(result);
    steps_.clear();
  } else if (steps_.empty() || steps_[0].kind != wire::kind_configure_motor) {
    configured_ = true;
    for (Motor& motor : motors_) motor.report.reset();  // of before
  }
}

void MotorDriver::zero_spools(std::uint8_t motors) {
  for (std::size_t i = 0; i < rig_.motors.size(); ++i)
    if ((motors & 1U << i) != 0) motors_[i].spool_steps = 0.0;
}

// The motors move from now on, though the next report of it is still to come.
void MotorDriver::take_on_targets() {
  counts_.acknowledged += static_cast<std::int64_t>(commands_in(sent_).size());
  for (std::size_t i = 0; i < rig_.motors.size(); ++i) {
    if (!sent_[i]) continue;
    motors_[i].last.target_microsteps = microsteps(static_cast<int>(i), sent_[i]->steps);
    motors_[i].last.flags |= wire::flag_moving;
  }
  sent_ = {};
}

void MotorDriver::on(const RequestLost& event) {
  if (event.kind == wire::kind_go_to) refuse_targets(sent_, "the link was lost before the board took it on");
}

void MotorDriver::on(const MotorReport& event) {
  if (event.motor >= static_cast<int>(rig_.motors.size())) return;
  const auto index = static_cast<std::size_t>(event.motor);
  const MotorSettings& settings = rig_.motors[index];
  Motor& motor = motors_[index];
  motor.report = motor.last = event;
  const double pulled = settings.direction * event.position_microsteps / double(settings.drive.microsteps);
  motor.spool_steps = std::clamp(motor.spool_steps, pulled, pulled + settings.backlash_steps);
}

// ---- what is sent

void MotorDriver::configure() {
  steps_.push_back({wire::kind_configure_board, board_payload(rig_), false});
  for (std::size_t i = 0; i < rig_.motors.size(); ++i) {
    steps_.push_back({wire::kind_configure_motor, motor_payload(rig_, static_cast<int>(i)), false});
  }
}

void MotorDriver::send_next(double now_s) {
  if (!link_.open() || link_.busy()) return;
  if (!steps_.empty()) {
    step_sent_ = true;
    link_.request(steps_[0].kind, steps_[0].payload, now_s);
  } else if (!commands_in(waiting_).empty()) {
    send_targets(now_s);
  }
}

std::int32_t MotorDriver::microsteps(int motor, double steps) const {
  return static_cast<std::int32_t>(std::lround(steps * rig_.motors[static_cast<std::size_t>(motor)].drive.microsteps));
}

void MotorDriver::send_targets(double now_s) {
  std::vector<std::uint8_t> payload(1);
  for (std::size_t i = 0; i < rig_.motors.size(); ++i) {
    if (!waiting_[i]) continue;
    payload[0] = static_cast<std::uint8_t>(payload[0] | 1U << i);
    payload.resize(payload.size() + wire::go_to::position_size);
    wire::put_i24(&payload[payload.size() - wire::go_to::position_size],
                  microsteps(static_cast<int>(i), waiting_[i]->steps));
  }
  sent_ = waiting_;
  waiting_ = {};
  link_.request(wire::kind_go_to, payload, now_s);
}

// ---- what is asked for

void MotorDriver::command(const std::vector<std::string>& names, const std::vector<double>& values, double now_s) {
  ++counts_.received;
  try {
    if (names.size() != values.size() || names.empty()) {
      throw std::invalid_argument("names and values: " + std::to_string(names.size()) + " and " +
                                  std::to_string(values.size()) + ", expected as many of each, and one at least");
    }
    if (now_s - last_command_s_ < rig_.min_command_period_s) {
      throw std::invalid_argument("comes within min_command_period_s = " + std::to_string(rig_.min_command_period_s) +
                                  " of the last command");
    }
    if (emergency_stopped_) throw std::invalid_argument("emergency stop: clear it first");
    if (!link_failure_.empty()) throw std::invalid_argument("no link: " + link_failure_);
    if (!ready()) throw std::invalid_argument("the positions have not been read yet");
    if (operation_ == OperationState::running)
      throw std::invalid_argument("the motors are being zeroed, stopped or cleared");
    Targets targets{};
    for (std::size_t i = 0; i < names.size(); ++i) {
      const int motor = index_of(names[i]);
      check(motor, values[i]);
      auto& target = targets[static_cast<std::size_t>(motor)];
      if (target) throw std::invalid_argument(names[i] + ": named twice");
      target = Target{shaft_target(motor, steps_of(rig_.motors[static_cast<std::size_t>(motor)], values[i])),
                      counts_.received};
    }
    const auto before = commands_in(waiting_);
    for (std::size_t i = 0; i < targets.size(); ++i) {
      if (targets[i]) waiting_[i] = targets[i];
    }
    const auto after = commands_in(waiting_);
    counts_.superseded += static_cast<std::int64_t>(before.size() + 1 - after.size());
    last_command_s_ = now_s;
  } catch (const std::invalid_argument& error) {
    ++counts_.refused;
    last_refusal_ = error.what();
    throw;
  }
}

int MotorDriver::index_of(const std::string& name) const {
  std::string known;
  for (std::size_t i = 0; i < rig_.motors.size(); ++i) {
    if (rig_.motors[i].name == name) return static_cast<int>(i);
    known += (i == 0 ? "" : ", ") + rig_.motors[i].name;
  }
  throw std::invalid_argument("'" + name + "' is not one of " + known);
}

void MotorDriver::check(int index, double value) const {
  const MotorSettings& motor = rig_.motors[static_cast<std::size_t>(index)];
  if (!(value >= motor.min_value && value <= motor.max_value)) {
    throw std::invalid_argument(motor.name + ": " + std::to_string(value) + " is not in [" +
                                std::to_string(motor.min_value) + ", " + std::to_string(motor.max_value) + "]; " +
                                (value < motor.min_value ? motor.min_key : motor.max_key) +
                                " of its rig's file moves that limit");
  }
  const std::string fault = fault_of(index);
  if (!fault.empty()) throw std::invalid_argument(motor.name + ": " + fault);
}

// Pulling, the spool is at the shaft; releasing, the shaft turns through the backlash first.
double MotorDriver::shaft_target(int index, double steps) const {
  const MotorSettings& motor = rig_.motors[static_cast<std::size_t>(index)];
  if (motor.backlash_steps == 0.0) return steps;
  const double spool = motors_[static_cast<std::size_t>(index)].spool_steps;
  const bool releases = motor.direction * steps < spool;
  return releases ? steps - motor.direction * motor.backlash_steps : steps;
}

void MotorDriver::emergency_stop() {
  emergency_stopped_ = true;
  link_.emergency_stop();
  emergency_sent_s_ = -1e9;
  refuse_targets(waiting_, "emergency stop");
  fail_operation("emergency stop");
}

void MotorDriver::zero(const std::vector<std::string>& names) { begin_operation(wire::kind_zero, mask_of(names)); }

void MotorDriver::soft_stop() { begin_operation(wire::kind_soft_stop, mask_of({})); }

void MotorDriver::clear() { begin_operation(wire::kind_clear, mask_of({})); }

std::uint8_t MotorDriver::mask_of(const std::vector<std::string>& names) const {
  if (names.empty()) return static_cast<std::uint8_t>((1U << rig_.motors.size()) - 1U);
  unsigned mask = 0;
  for (const std::string& name : names) mask |= 1U << index_of(name);
  return static_cast<std::uint8_t>(mask);
}

void MotorDriver::begin_operation(wire::Kind kind, std::uint8_t mask) {
  operation_failure_.clear();
  operation_ = OperationState::running;
  if (!link_failure_.empty()) return fail_operation("no link: " + link_failure_);
  if (!ready()) return fail_operation("the positions have not been read yet");
  refuse_targets(waiting_, "replaced by a request to zero, stop or clear");
  steps_.push_back({kind, {mask}, true});
}

void MotorDriver::finish(bool done, const std::string& why) {
  if (operation_ != OperationState::running) return;
  operation_ = done ? OperationState::done : OperationState::failed;
  if (!done) operation_failure_ = why;
}

void MotorDriver::fail_operation(const std::string& why) {
  if (operation_ != OperationState::running) return;
  operation_ = OperationState::failed;
  operation_failure_ = why;
  // One that was sent already is answered all the same; nobody waits for it.
  steps_.erase(std::remove_if(steps_.begin() + (step_sent_ ? 1 : 0), steps_.end(),
                              [](const Step& step) { return step.operation; }),
               steps_.end());
}

void MotorDriver::refuse_targets(Targets& targets, const std::string& why) {
  const auto commands = commands_in(targets);
  if (!commands.empty()) last_refusal_ = why;
  counts_.refused += static_cast<std::int64_t>(commands.size());
  targets = {};
}

// ---- what is reported

std::string MotorDriver::fault_of(int index) const {
  const Motor& motor = motors_[static_cast<std::size_t>(index)];
  if (!link_failure_.empty()) return "no link: " + link_failure_;
  if (!motor.report) return "not heard of yet";
  return words_of_flags(motor.report->flags);
}

std::vector<MotorStatus> MotorDriver::motors() const {
  std::vector<MotorStatus> all;
  for (std::size_t i = 0; i < rig_.motors.size(); ++i) {
    const Motor& motor = motors_[i];
    const double unit = rig_.motors[i].drive.microsteps;
    MotorStatus status;
    status.position_steps = motor.last.position_microsteps / unit;
    status.target_steps = motor.last.target_microsteps / unit;
    if (sent_[i]) status.target_steps = sent_[i]->steps;
    if (waiting_[i]) status.target_steps = waiting_[i]->steps;
    status.spool_steps = motor.spool_steps;
    status.flags = motor.last.flags;
    status.known = ready() && (motor.last.flags & wire::flag_known) != 0;
    status.moving = (motor.last.flags & wire::flag_moving) != 0 || sent_[i] || waiting_[i];
    status.fault = fault_of(static_cast<int>(i));
    all.push_back(status);
  }
  return all;
}

CommandCounts MotorDriver::commands() const {
  CommandCounts counts = counts_;
  counts.pending = static_cast<std::int64_t>(commands_in(waiting_).size() + commands_in(sent_).size());
  return counts;
}

}  // namespace soft_robot_lab
