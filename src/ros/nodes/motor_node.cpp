// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <chrono>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <soft_robot_lab/ActuatorCommand.h>
#include <soft_robot_lab/ZeroMotors.h>
#include <std_srvs/Trigger.h>

#include "read_parameter.h"
#include "run_node.h"
#include "hardware/motor/motor_driver.h"
#include "hardware/motor/pressure_driver.h"
#include "hardware/motor/serial_port.h"
#include "ros/base/log_text.h"
#include "ros/base/node_diagnosis.h"
#include "ros/messages/message_limits.h"
#include "ros/messages/motor_messages.h"
#include "ros/base/topics.h"

namespace soft_robot_lab {
namespace {

constexpr const char* kMotorAbout = R"(Drives the rig's motors, or its pressure channels, by actuators/command.

Parameters: ~rig (path), ~device (instead of the one in the rig's file), ~zero_at_start (of motors: the
robot hangs at rest when the rig gets power: take that for zero).)";

using SteadyClock = std::chrono::steady_clock;

double now_s() { return std::chrono::duration<double>(SteadyClock::now().time_since_epoch()).count(); }

RigSettings read_rig(const ros::NodeHandle& node) {
  RigSettings rig = load_rig(required_text(node, "rig", "the path of a rig's file"));
  const std::string device = text_parameter(node, "device");
  if (!device.empty()) rig.device = device;
  return rig;
}

DriverOptions read_options(const ros::NodeHandle& node) {
  DriverOptions options;
  read_parameter(node, "zero_at_start", options.zero_at_start);
  // Another session than the last run's, which the board may still be in.
  options.first_session = static_cast<std::uint8_t>(ros::WallTime::now().toNSec() / 1000000);
  return options;
}

// What is the same for motors and for air: topics, services, the lamp and the loop.
template <class Driver>
class DriveNode {
 public:
  DriveNode(const RigSettings& rig, const DriverOptions& options)
      : driver_(rig, options, [device = rig.device] { return open_serial_port(device); }), diagnosis_(rig.device) {
    state_ = node_.advertise<MotorState>(topics::motor_state, 10);
    commands_ = node_.subscribe(topics::actuator_command, 100, &DriveNode::on_command, this);
    stop_ = node_.advertiseService(topics::motor_stop, &DriveNode::stop, this);
    clear_ = node_.advertiseService(topics::motor_clear, &DriveNode::clear, this);
    diagnosis_.add("motors", [this](auto& status) { diagnose(driver_, status); });
    diagnosis_.start();
    state_timer_ =
        node_.createSteadyTimer(ros::WallDuration(state_period_s), [this](const auto&) { publish(ros::Time::now()); });
  }
  virtual ~DriveNode() = default;

  void run() {
    while (ros::ok()) {
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(poll_period_s));
      update();
    }
    driver_.soft_stop();
    finish(0.3);
  }

 protected:
  virtual void publish(const ros::Time& stamp) { state_.publish(motor_state(driver_, stamp)); }

  static constexpr double state_period_s = 0.02;
  static constexpr double poll_period_s = 0.002;
  static constexpr double longest_start_s = 2.0;
  static constexpr double longest_operation_s = 2.0;

  void update() {
    driver_.update(now_s());
    const std::string& failure = driver_.link_failure();
    if (logged_failure_ == failure || (!failure.empty() && starts())) return;
    logged_failure_ = failure;
    if (failure.empty())
      ROS_INFO("linked to %s", driver_.rig().device.c_str());
    else
      ROS_WARN("no link: %s", log_text(failure).c_str());
  }

  // An emulated board starts beside this node: until then nothing is wrong.
  bool starts() const { return !logged_failure_ && now_s() - started_s_ < longest_start_s; }

  void on_command(const ActuatorCommand& command) {
    try {
      require_in_limits<ActuatorCommand>(command);
      driver_.command(command.names, command.values, sent_s(command.header.stamp));
    } catch (const std::invalid_argument& error) {
      ROS_WARN_THROTTLE(1.0, "%s refused: %s", topics::actuator_command, log_text(error.what()).c_str());
    }
  }

  // By the machine's time. Commands that were sent apart may wait together for this node, and do not follow one another
  // too fast for that. A stamp that cannot be true, or none, stands for now.
  static double sent_s(const ros::Time& stamp) {
    constexpr double longest_wait_s = 1.0;
    const double waited_s = stamp.isZero() ? 0.0 : (ros::Time::now() - stamp).toSec();
    return now_s() - (waited_s > 0.0 && waited_s < longest_wait_s ? waited_s : 0.0);
  }

  // The link takes milliseconds; a board that does not answer counts as lost long before the limit.
  void finish(double limit_s) {
    const double end_s = now_s() + limit_s;
    while (driver_.operation() == OperationState::running && now_s() < end_s) {
      update();
      ros::WallDuration(poll_period_s).sleep();
    }
  }

  template <typename Response>
  bool answer(Response& response, const std::string& done) {
    finish(longest_operation_s);
    response.success = driver_.operation() == OperationState::done;
    response.message = response.success ? done : driver_.operation_failure();
    if (!response.success && response.message.empty()) response.message = "no answer in time";
    return true;
  }

  bool stop(std_srvs::Trigger::Request& /*request*/, std_srvs::Trigger::Response& response) {
    driver_.emergency_stop();
    update();
    response.success = true;
    response.message = driver_.linked() ? "emergency stop sent" : "emergency stop is sent as soon as there is a link";
    return true;
  }

  bool clear(std_srvs::Trigger::Request& /*request*/, std_srvs::Trigger::Response& response) {
    driver_.clear();
    return answer(response, "faults and emergency stop cleared");
  }

  Driver driver_;
  const double started_s_ = now_s();
  std::optional<std::string> logged_failure_;  // empty: a link; none: nothing was said yet
  ros::NodeHandle node_;

 private:
  ros::Publisher state_;
  ros::Subscriber commands_;
  ros::ServiceServer stop_, clear_;
  NodeDiagnosis diagnosis_;
  ros::SteadyTimer state_timer_;
};

class MotorNode : public DriveNode<MotorDriver> {
 public:
  MotorNode(const RigSettings& rig, const DriverOptions& options) : DriveNode(rig, options) {
    zero_ = node_.advertiseService(topics::motor_zero, &MotorNode::zero, this);
  }

 private:
  static constexpr double longest_report_s = 0.2;  // of states that come each 20 ms

  bool at_zero(const std::vector<std::string>& names) const {
    const std::vector<MotorStatus> motors = driver_.motors();
    for (std::size_t i = 0; i < motors.size(); ++i) {
      const bool asked = names.empty() || std::count(names.begin(), names.end(), driver_.rig().motors[i].name) > 0;
      if (asked && !(motors[i].known && motors[i].position_steps == 0.0)) return false;
    }
    return true;
  }

  void wait_for_zero(const std::vector<std::string>& names) {
    const double end_s = now_s() + longest_report_s;
    while (driver_.operation() == OperationState::done && !at_zero(names) && now_s() < end_s) {
      update();
      ros::WallDuration(poll_period_s).sleep();
    }
  }

  bool zero(ZeroMotors::Request& request, ZeroMotors::Response& response) {
    try {
      driver_.zero(request.names);
    } catch (const std::invalid_argument& error) {
      response.message = answer_text(error);
      return true;
    }
    finish(longest_operation_s);
    wait_for_zero(request.names);  // the board says that it is done before it reports where the motors are
    publish(ros::Time::now());
    return answer(response, "here is zero");
  }

  ros::ServiceServer zero_;
};

class PressureNode : public DriveNode<PressureDriver> {
 public:
  PressureNode(const RigSettings& rig, const DriverOptions& options) : DriveNode(rig, options) {
    pressures_ = node_.advertise<PressureState>(topics::pressure_state, 10);
  }

 private:
  void publish(const ros::Time& stamp) override {
    DriveNode::publish(stamp);
    pressures_.publish(pressure_state(driver_, stamp));
  }

  ros::Publisher pressures_;
};

void run_driver(const RigSettings& rig, const DriverOptions& options) {
  if (rig.channels.empty()) {
    MotorNode(rig, options).run();
  } else {
    PressureNode(rig, options).run();
  }
}

}  // namespace

int motor_node(int argc, char** argv) {
  return run_node(argc, argv, "motor", kMotorAbout, [] {
    const ros::NodeHandle node("~");
    run_driver(read_rig(node), read_options(node));
  });
}

}  // namespace soft_robot_lab
