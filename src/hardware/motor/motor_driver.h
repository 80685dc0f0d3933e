// SPDX-License-Identifier: BSD-3-Clause
// Drives a rig: values of actuators to shaft positions, within limits, through a link that may fail. Each command ends
// as acknowledged, superseded or refused, and is counted. Never waits; time is an argument.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "link.h"
#include "rig_settings.h"

namespace soft_robot_lab {

struct DriverOptions {
  std::uint8_t first_session = 1;  // of the link: any but the last run's
  // The robot hangs at rest when the rig gets power: take that for zero, once, at the first connection.
  bool zero_at_start = false;
};

struct CommandCounts {
  std::int64_t received = 0;      // always the sum of the others
  std::int64_t acknowledged = 0;  // the board has taken it on
  std::int64_t superseded = 0;    // by a newer one before it was sent
  std::int64_t refused = 0;       // here or by the board
  std::int64_t pending = 0;
};

// Positions are the shaft's, in full steps.
struct MotorStatus {
  double position_steps = 0.0;
  double target_steps = 0.0;
  double spool_steps = 0.0;  // behind the backlash
  bool known = false;        // has counted every step since zero, and was heard of just now
  bool moving = false;
  std::uint16_t flags = 0;  // wire::Flag
  std::string fault;        // why it does not move, or empty
};

// zero, soft stop and clear: asked of the board, done when it says so.
enum class OperationState { none, running, done, failed };

class MotorDriver {
 public:
  MotorDriver(RigSettings rig, DriverOptions options, OpenPort open_port);

  void update(double now_s);
  // Throws std::invalid_argument: name, value and what is allowed. All motors of the command move, or none.
  void command(const std::vector<std::string>& names, const std::vector<double>& values, double now_s);

  void emergency_stop();  // wins over everything, and holds until clear()
  // These replace what was asked for before. Motors by name; none: all.
  void zero(const std::vector<std::string>& names = {});
  void soft_stop();
  void clear();  // faults and the emergency stop
  OperationState operation() const { return operation_; }
  const std::string& operation_failure() const { return operation_failure_; }

  bool linked() const { return link_.open(); }
  bool ready() const;  // linked, configured, and all positions read since
  const std::string& link_failure() const { return link_failure_; }
  bool emergency_stopped() const { return emergency_stopped_; }
  std::vector<MotorStatus> motors() const;
  const RigSettings& rig() const { return rig_; }
  CommandCounts commands() const;
  const LinkCounts& link_counts() const { return link_.counts(); }
  const std::string& last_refusal() const { return last_refusal_; }

 private:
  struct Target {
    double steps;
    std::int64_t command;  // that asked for it
  };
  using Targets = std::array<std::optional<Target>, wire::max_motors>;
  struct Motor {
    std::optional<MotorReport> report;  // since the link was opened
    MotorReport last{};
    double spool_steps = 0.0;
  };
  struct Step {  // of an operation or of the configuration
    wire::Kind kind;
    std::vector<std::uint8_t> payload;
    bool operation;
  };

  void on(const LinkOpened& event);
  void on(const LinkLost& event);
  void on(const RequestAnswered& event);
  void on(const RequestLost& event);
  void on(const MotorReport& event);
  void configure();
  void send_next(double now_s);
  void send_targets(double now_s);
  void take_on_targets();
  void end_configuring(wire::Result result);
  void zero_spools(std::uint8_t motors);  // by bits
  std::int32_t microsteps(int motor, double steps) const;
  void finish(bool done, const std::string& why);
  void begin_operation(wire::Kind kind, std::uint8_t mask);
  void fail_operation(const std::string& why);
  void refuse_targets(Targets& targets, const std::string& why);
  std::uint8_t mask_of(const std::vector<std::string>& names) const;
  int index_of(const std::string& name) const;
  void check(int motor, double value) const;
  double shaft_target(int motor, double steps) const;
  std::string fault_of(int motor) const;

  RigSettings rig_;
  DriverOptions options_;
  Link link_;
  bool configured_ = false;
  bool emergency_stopped_ = false;
  bool zero_at_start_due_;
  std::array<Motor, wire::max_motors> motors_{};
  Targets waiting_{}, sent_{};
  std::deque<Step> steps_;
  bool step_sent_ = false;
  OperationState operation_ = OperationState::none;
  std::string operation_failure_;
  std::string link_failure_ = "not connected yet";
  std::string last_refusal_;
  double last_command_s_ = -1e9;
  double emergency_sent_s_ = -1e9;
  CommandCounts counts_;
};

}  // namespace soft_robot_lab
