// SPDX-License-Identifier: BSD-3-Clause
// What drivers of all rigs share: values of actuators to targets of drives, within limits, through a link that may
// fail. Each command ends as acknowledged, superseded or refused, and is counted. Never waits; time is an argument.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "link.h"
#include "rig_settings.h"

namespace soft_robot_lab {

struct DriverOptions {
  std::uint8_t first_session = 1;  // of the link: any but the last run's
  // Of motors. The robot hangs at rest when the rig gets power: take that for zero, once, at the first connection.
  bool zero_at_start = false;
};

struct CommandCounts {
  std::int64_t received = 0;      // always the sum of the others
  std::int64_t acknowledged = 0;  // the board has taken it on
  std::int64_t superseded = 0;    // by a newer one before it was sent
  std::int64_t refused = 0;       // here or by the board
  std::int64_t pending = 0;
};

// zero, soft stop and clear: asked of the board, done when it says so.
enum class OperationState { none, running, done, failed };

class RigDriver {
 public:
  virtual ~RigDriver() = default;
  RigDriver(const RigDriver&) = delete;
  RigDriver& operator=(const RigDriver&) = delete;

  void update(double now_s);
  // Throws std::invalid_argument: name, value and what is allowed. All drives of the command move, or none.
  void command(const std::vector<std::string>& names, const std::vector<double>& values, double now_s);

  void emergency_stop();  // wins over everything, and holds until clear()
  // These replace what was asked for before.
  void soft_stop();  // motors brake; air is let out
  void clear();      // faults and the emergency stop
  OperationState operation() const { return operation_.state; }
  const std::string& operation_failure() const { return operation_.failure; }

  bool linked() const { return link_.open(); }
  bool ready() const;  // linked, configured, and all states read since
  const std::string& link_failure() const { return link_failure_; }
  bool emergency_stopped() const { return emergency_.on; }
  const RigSettings& rig() const { return rig_; }
  CommandCounts commands() const;
  const LinkCounts& link_counts() const { return link_.counts(); }
  const std::string& last_refusal() const { return last_refusal_; }

 protected:
  RigDriver(RigSettings rig, const DriverOptions& options, OpenPort open_port);

  struct Drive {
    std::optional<DriveReport> report;  // since the link was opened
    DriveReport last{};
  };
  struct Step {  // of an operation or of the configuration
    BoardRequest request;
    bool operation;
  };

  // A target is in the drive's own unit, as a double; on the wire it is a whole number.
  virtual double target_of(int drive, double value) const = 0;
  virtual std::int32_t on_wire(int drive, double target) const = 0;
  virtual std::string words_of_flags(std::uint16_t flags) const = 0;  // why it does not move; empty where it may
  // Why the drive does not move, or empty.
  virtual std::string fault_of(int drive) const;
  virtual void on_ready() {}  // all states are known
  virtual void on_report(const DriveReport&) {}
  virtual void on_done(const BoardRequest&) {}  // a step

  std::size_t count() const { return limits_.size(); }
  const Drive& drive(std::size_t index) const { return drives_[index]; }
  std::optional<double> asked_target(std::size_t index) const;  // that the board has not taken on yet
  void begin_operation(wire::Kind kind, std::uint8_t mask);
  void add_step(BoardRequest request) { steps_.due.push_back({std::move(request), false}); }
  std::uint8_t mask_of(const std::vector<std::string>& names) const;  // none: all

 private:
  struct Target {
    double value;
    std::int64_t command;  // that asked for it
  };
  using Targets = std::array<std::optional<Target>, wire::max_motors>;
  struct Operation {
    OperationState state = OperationState::none;
    std::string failure;
  };
  struct EmergencyStop {
    bool on = false;
    double sent_s = -1e9;
  };
  struct Steps {
    std::deque<Step> due;
    bool first_sent = false;
  };

  void on(const LinkOpened& event);
  void on(const LinkLost& event);
  void on(const RequestAnswered& event);
  void on(const RequestLost& event);
  void on(const DriveReport& event);
  static std::set<std::int64_t> commands_in(const Targets& targets);
  void repeat_emergency_stop(double now_s);
  void require_ready(double now_s) const;
  void configure();
  void send_next(double now_s);
  void send_targets(double now_s);
  void take_on_targets();
  void end_configuring(wire::Result result);
  void finish(bool done, const std::string& why);
  void fail_operation(const std::string& why);
  void refuse_targets(Targets& targets, const std::string& why);
  int index_of(const std::string& name) const;
  void check(int drive, double value) const;

  RigSettings rig_;
  std::vector<DriveLimits> limits_;  // of all drives
  Link link_;
  bool configured_ = false;
  bool was_ready_ = false;
  EmergencyStop emergency_;
  std::array<Drive, wire::max_motors> drives_{};
  Targets waiting_{}, sent_{};
  Steps steps_;
  Operation operation_;
  std::string link_failure_ = "not connected yet";
  std::string last_refusal_;
  double last_command_s_ = -1e9;
  CommandCounts counts_;
};

}  // namespace soft_robot_lab
