// SPDX-License-Identifier: BSD-3-Clause
#include "rig_driver.h"

#include <algorithm>
#include <stdexcept>

#include "words.h"

namespace soft_robot_lab {
namespace {

constexpr const char* kUnread = "the drives' states have not been read yet";
constexpr double emergency_period_s = 0.02;
constexpr double kLostBeforeWatchdog = 0.6;  // of its time: both ends then agree that the link is lost

LinkOptions link_options(const RigSettings& rig, const DriverOptions& options) {
  LinkOptions link;
  link.firmware = rig.firmware();
  link.lost_s = kLostBeforeWatchdog * rig.watchdog_s;
  link.first_session = options.first_session;
  return link;
}

}  // namespace

RigDriver::RigDriver(RigSettings rig, const DriverOptions& options, OpenPort open_port)
    : rig_(std::move(rig)),
      limits_(drive_limits(rig_)),
      link_(link_options(rig_, options), configuration_crc(rig_), std::move(open_port)) {}

void RigDriver::update(double now_s) {
  for (const LinkEvent& event : link_.update(now_s)) {
    std::visit([this](const auto& event_of_kind) { on(event_of_kind); }, event);
  }
  repeat_emergency_stop(now_s);
  if (ready() && !was_ready_) on_ready();
  was_ready_ = ready();
  send_next(now_s);
}

void RigDriver::repeat_emergency_stop(double now_s) {
  const bool clearing = operation_.state == OperationState::running && !steps_.due.empty() &&
                        steps_.due[0].request.kind == wire::kind_clear;
  if (!emergency_.on || clearing || now_s - emergency_.sent_s < emergency_period_s) return;
  const bool heard = std::all_of(
      drives_.begin(), drives_.begin() + static_cast<std::ptrdiff_t>(count()),
      [](const Drive& drive) { return drive.report && (drive.report->flags & wire::flag_emergency_stop) != 0; });
  if (!heard) link_.emergency_stop();
  emergency_.sent_s = now_s;
}

bool RigDriver::ready() const {
  return link_.open() && configured_ &&
         std::all_of(drives_.begin(), drives_.begin() + static_cast<std::ptrdiff_t>(count()),
                     [](const Drive& drive) { return drive.report.has_value(); });
}

// ---- what the link reports

void RigDriver::on(const LinkOpened& event) {
  for (Drive& drive : drives_) drive.report.reset();
  steps_.due.clear();
  steps_.first_sent = false;
  configured_ = event.same_configuration;
  link_failure_ = why_not_driven(rig_, event.drive_count);
  if (!link_failure_.empty()) {
    configured_ = false;
  } else if (!configured_) {
    configure();
  }
}

void RigDriver::on(const LinkLost& event) {
  link_failure_ = event.reason;
  configured_ = false;
  steps_.due.clear();
  steps_.first_sent = false;
  refuse_targets(waiting_, "the link was lost: " + event.reason);
  fail_operation("the link was lost: " + event.reason);
}

void RigDriver::on(const RequestAnswered& event) {
  const bool done = event.result == wire::result_done;
  if (event.kind == wire::kind_go_to) {
    if (done) {
      take_on_targets();
    } else {
      refuse_targets(sent_, words(event.result));
    }
    return;
  }
  if (!steps_.first_sent || steps_.due.empty() || steps_.due[0].request.kind != event.kind) return;
  steps_.first_sent = false;
  const bool configuring = wire::is_configuration(event.kind);
  if (configuring && event.result == wire::result_moving) return;  // motors still slow down: once more
  const Step step = steps_.due[0];
  steps_.due.pop_front();
  if (configuring) end_configuring(event.result);
  if (done) on_done(step.request);
  // An emergency stop since then has failed the operation, and holds.
  if (step.request.kind == wire::kind_clear && done && operation_.state == OperationState::running) {
    emergency_.on = false;
  }
  if (step.operation) finish(done, words(event.result));
}

// Of the board, or of one drive.
void RigDriver::end_configuring(wire::Result result) {
  if (result != wire::result_done) {
    link_failure_ = "the board refused its configuration: " + words(result);
    steps_.due.clear();
  } else if (steps_.due.empty() || !wire::is_configuration(steps_.due[0].request.kind)) {
    configured_ = true;
    for (Drive& drive : drives_) drive.report.reset();  // of before
  }
}

// The drives move from now on, though the next report of it is still to come.
void RigDriver::take_on_targets() {
  counts_.acknowledged += static_cast<std::int64_t>(commands_in(sent_).size());
  for (std::size_t i = 0; i < count(); ++i) {
    if (!sent_[i]) continue;
    drives_[i].last.target = on_wire(static_cast<int>(i), sent_[i]->value);
    drives_[i].last.flags |= wire::flag_moving;
  }
  sent_ = {};
}

void RigDriver::on(const RequestLost& event) {
  if (event.kind == wire::kind_go_to) refuse_targets(sent_, "the link was lost before the board took it on");
}

void RigDriver::on(const DriveReport& event) {
  if (event.drive >= static_cast<int>(count())) return;
  Drive& drive = drives_[static_cast<std::size_t>(event.drive)];
  drive.report = drive.last = event;
  on_report(event);
}

// ---- what is sent

void RigDriver::configure() {
  for (BoardRequest& request : configuration(rig_)) add_step(std::move(request));
}

void RigDriver::send_next(double now_s) {
  if (!link_.open() || link_.busy()) return;
  if (!steps_.due.empty()) {
    steps_.first_sent = true;
    link_.request(steps_.due[0].request.kind, steps_.due[0].request.payload, now_s);
  } else if (!commands_in(waiting_).empty()) {
    send_targets(now_s);
  }
}

void RigDriver::send_targets(double now_s) {
  BoardRequest request{wire::kind_go_to, std::vector<std::uint8_t>(1)};
  std::vector<std::uint8_t>& payload = request.payload;
  for (std::size_t i = 0; i < count(); ++i) {
    if (!waiting_[i]) continue;
    payload[0] = static_cast<std::uint8_t>(payload[0] | 1U << i);
    payload.resize(payload.size() + wire::go_to::position_size);
    wire::put_i24(&payload[payload.size() - wire::go_to::position_size],
                  on_wire(static_cast<int>(i), waiting_[i]->value));
  }
  sent_ = waiting_;
  waiting_ = {};
  link_.request(request.kind, payload, now_s);
}

// ---- what is asked for

void RigDriver::command(const std::vector<std::string>& names, const std::vector<double>& values, double now_s) {
  ++counts_.received;
  try {
    if (names.size() != values.size() || names.empty()) {
      throw std::invalid_argument("names and values: " + std::to_string(names.size()) + " and " +
                                  std::to_string(values.size()) + ", expected as many of each, and one at least");
    }
    require_ready(now_s);
    Targets targets{};
    for (std::size_t i = 0; i < names.size(); ++i) {
      const int drive = index_of(names[i]);
      check(drive, values[i]);
      auto& target = targets[static_cast<std::size_t>(drive)];
      if (target) throw std::invalid_argument(names[i] + ": named twice");
      target = Target{target_of(drive, values[i]), counts_.received};
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

void RigDriver::require_ready(double now_s) const {
  if (now_s - last_command_s_ < rig_.min_command_period_s) {
    throw std::invalid_argument("comes within min_command_period_s = " + std::to_string(rig_.min_command_period_s) +
                                " of the last command");
  }
  if (emergency_.on) throw std::invalid_argument("emergency stop: clear it first");
  if (!link_failure_.empty()) throw std::invalid_argument("no link: " + link_failure_);
  if (!ready()) throw std::invalid_argument(kUnread);
  if (operation_.state == OperationState::running)
    throw std::invalid_argument("the drives are being zeroed, stopped or cleared");
}

int RigDriver::index_of(const std::string& name) const {
  std::string known;
  for (std::size_t i = 0; i < count(); ++i) {
    if (limits_[i].name == name) return static_cast<int>(i);
    known += (i == 0 ? "" : ", ") + limits_[i].name;
  }
  throw std::invalid_argument("'" + name + "' is not one of " + known);
}

void RigDriver::check(int index, double value) const {
  const DriveLimits& drive = limits_[static_cast<std::size_t>(index)];
  if (!(value >= drive.min_value && value <= drive.max_value)) {
    const std::string& key = value < drive.min_value ? drive.min_key : drive.max_key;
    throw std::invalid_argument(drive.name + ": " + std::to_string(value) + " is not in [" +
                                std::to_string(drive.min_value) + ", " + std::to_string(drive.max_value) + "]" +
                                (key.empty() ? "" : "; " + key + " of its rig's file moves that limit"));
  }
  const std::string fault = fault_of(index);
  if (!fault.empty()) throw std::invalid_argument(drive.name + ": " + fault);
}

void RigDriver::emergency_stop() {
  emergency_.on = true;
  link_.emergency_stop();
  emergency_.sent_s = -1e9;
  refuse_targets(waiting_, "emergency stop");
  fail_operation("emergency stop");
}

void RigDriver::soft_stop() { begin_operation(wire::kind_soft_stop, mask_of({})); }

void RigDriver::clear() { begin_operation(wire::kind_clear, mask_of({})); }

std::uint8_t RigDriver::mask_of(const std::vector<std::string>& names) const {
  if (names.empty()) return static_cast<std::uint8_t>((1U << count()) - 1U);
  unsigned mask = 0;
  for (const std::string& name : names) mask |= 1U << index_of(name);
  return static_cast<std::uint8_t>(mask);
}

void RigDriver::begin_operation(wire::Kind kind, std::uint8_t mask) {
  operation_.failure.clear();
  operation_.state = OperationState::running;
  if (!link_failure_.empty()) return fail_operation("no link: " + link_failure_);
  if (!ready()) return fail_operation(kUnread);
  refuse_targets(waiting_, "replaced by a request to zero, stop or clear");
  steps_.due.push_back({{kind, {mask}}, true});
}

void RigDriver::finish(bool done, const std::string& why) {
  if (operation_.state != OperationState::running) return;
  operation_.state = done ? OperationState::done : OperationState::failed;
  if (!done) operation_.failure = why;
}

void RigDriver::fail_operation(const std::string& why) {
  if (operation_.state != OperationState::running) return;
  operation_.state = OperationState::failed;
  operation_.failure = why;
  // One that was sent already is answered all the same; nobody waits for it.
  steps_.due.erase(std::remove_if(steps_.due.begin() + (steps_.first_sent ? 1 : 0), steps_.due.end(),
                                  [](const Step& step) { return step.operation; }),
                   steps_.due.end());
}

std::set<std::int64_t> RigDriver::commands_in(const Targets& targets) {
  std::set<std::int64_t> commands;
  for (const auto& target : targets) {
    if (target) commands.insert(target->command);
  }
  return commands;
}

void RigDriver::refuse_targets(Targets& targets, const std::string& why) {
  const auto commands = commands_in(targets);
  if (!commands.empty()) last_refusal_ = why;
  counts_.refused += static_cast<std::int64_t>(commands.size());
  targets = {};
}

// ---- what is reported

std::string RigDriver::fault_of(int index) const {
  const Drive& drive = drives_[static_cast<std::size_t>(index)];
  if (!link_failure_.empty()) return "no link: " + link_failure_;
  if (!drive.report) return "not heard of yet";
  return words_of_flags(drive.report->flags);
}

std::optional<double> RigDriver::asked_target(std::size_t index) const {
  if (waiting_[index]) return waiting_[index]->value;
  if (sent_[index]) return sent_[index]->value;
  return std::nullopt;
}

CommandCounts RigDriver::commands() const {
  CommandCounts counts = counts_;
  counts.pending = static_cast<std::int64_t>(commands_in(waiting_).size() + commands_in(sent_).size());
  return counts;
}

}  // namespace soft_robot_lab
