// SPDX-License-Identifier: BSD-3-Clause
// Plays a policy on whatever listens to the actuator commands and, in closed loop, corrects it by what tracked markers
// show. Driven by the stamps of messages, so in whatever time a session runs. One thread executes and waits; others add
// what topics say.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <soft_robot_lab/ExecutePolicy.h>

#include "soft_robot_lab/control/closed_loop.h"
#include "soft_robot_lab/control/policy.h"
#include "motor_watch.h"
#include "session/measured_rest.h"
#include "session/rest_detector.h"

namespace soft_robot_lab {

struct ExecutionOrder {
  CommandPolicy policy;
  std::vector<double> start_values;  // of its actuators
  bool wait_until_rest = true;
  double time_limit_s = 30.0;  // of session time, for all of it
  ClosedLoop* loop = nullptr;  // starts where the policy ends; none: nothing is corrected
};

class Execution {
 public:
  using Send = std::function<void(const std::vector<std::string>& names, const std::vector<double>& values)>;

  Execution(const ClosedLoopOptions& loop_options, Send send) : loop_options_(loop_options), send_(std::move(send)) {}

  // Throws std::runtime_error where another policy is executed, or a motor may not move; nothing is sent then.
  ExecutePolicy::Response execute(const ExecutionOrder& order);

  bool running() const;
  bool cancel();  // false where nothing is executed; an execution ends where it is

  void add_simulated(const MarkerObservations& markers);
  void add_measured(const MarkerObservations& markers);
  void add_motors(const MotorState& state);

 private:
  struct Run {
    explicit Run(const ExecutionOrder& asked) : order(asked), player(asked.policy, asked.start_values) {}

    const ExecutionOrder& order;
    PolicyPlayer player;
    RestDetector rest;
    std::optional<double> start_s;  // stamp of the first markers
    double now_s = 0.0;             // of the last
    double seen_s = 0.0;            // when a marker that cameras see was last reported
    ros::SteadyTime heard = ros::SteadyTime::now();
    ros::SteadyTime commanded;  // when the last command was sent,
    double commanded_s = 0.0;   // and in session time
    bool sent = false;          // the policy's last command
    bool rested = false;
    bool cancelled = false;
    std::string fault;
    ExecutePolicy::Response answer;

    double elapsed_s() const { return start_s ? now_s - *start_s : 0.0; }
  };

  // Empty where it was reached, else what came first.
  std::string wait(std::unique_lock<std::mutex>& lock, const std::function<bool()>& reached);
  std::string problem() const;
  std::string correct(std::unique_lock<std::mutex>& lock);
  bool may_correct(double after_s) const;
  bool follow_clock(double stamp_s);  // false where it jumped, which ends the run
  void play();
  void repeat();
  void send(const std::vector<std::string>& names, const std::vector<double>& values);
  void look_at_motors();

  ClosedLoopOptions loop_options_;
  Send send_;
  mutable std::mutex mutex_;  // guards what follows; held briefly
  std::condition_variable changed_;
  std::optional<Run> run_;
  MotorWatch motors_;
  MeasuredRest measured_rest_;
};

}  // namespace soft_robot_lab
