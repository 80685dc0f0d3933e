// SPDX-License-Identifier: BSD-3-Clause
// Plays a policy on actuators and, in closed loop, corrects it by what tracked markers show; or, where it has come to
// rest, follows a path. Driven by the stamps of markers, so in whatever time a session runs. One thread executes and
// waits; others add what they hear.
#pragma once

#include <condition_variable>
#include <functional>
#include <limits>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/control/closed_loop.h"
#include "soft_robot_lab/control/policy.h"
#include "followed_path.h"
#include "marker_frame.h"
#include "measured_rest.h"
#include "motor_watch.h"
#include "rest_detector.h"

namespace soft_robot_lab {

struct ExecutionOrder {
  CommandPolicy policy;
  std::vector<double> start_values;  // of its actuators
  bool wait_until_rest = true;
  double time_limit_s = 30.0;        // of session time, for all of it
  ClosedLoop* loop = nullptr;        // starts where the policy ends; none: nothing is corrected
  PathFollower* follower = nullptr;  // starts where the policy has come to rest; in place of a loop
  std::size_t followed_marker = 0;   // among the simulated ones
  std::function<void(double path_s, std::optional<double> distance_m)> on_path = {};  // at each command; quick
};

struct ExecutionReport {
  bool success = false;
  std::string message;                                              // why not, or how a correction ended
  double duration_s = 0.0;                                          // of session time
  int corrections = 0;                                              // commands sent in closed loop
  double final_distance_m = -1.0;                                   // measured at the last rest; -1: not known
  std::vector<std::string> names;                                   // of actuators
  std::vector<double> values;                                       // and what they were sent last
  std::optional<double> simulated_s, measured_s;                    // stamps of the last markers that were heard
  std::optional<double> measured_path_rms_m, simulated_path_rms_m;  // of the followed marker from where it should be
  MarkerTrack measured_path;                                        // by times since the path's start
};

// What an execution needs of the process it runs in.
struct ExecutionHost {
  std::function<void(const std::vector<std::string>& names, const std::vector<double>& values)> send;
  std::function<double()> machine_time_s;  // of a clock that nobody sets
  std::function<bool()> ends = [] { return false; };
};

class Execution {
 public:
  Execution(const ClosedLoopOptions& loop_options, ExecutionHost host)
      : loop_options_(loop_options), host_(std::move(host)) {}

  // Throws std::runtime_error where another policy is executed, or a motor may not move; nothing is sent then.
  ExecutionReport execute(const ExecutionOrder& order);

  bool running() const;
  bool has_motors() const;  // heard of so far; else the robot is simulated
  bool cancel();            // false where nothing is executed; an execution ends where it is

  void add_simulated(double stamp_s, const std::vector<Eigen::Vector3d>& positions_m);
  void add_measured(const MarkerFrame& frame);
  void add_motors(MotorWatchReport report);
  // The commands that simulated drives heard last, one a name. Where they report, rest is awaited from there on: a
  // simulation that runs ahead of the machine's messages would rest before it hears anything.
  void add_drives(const std::vector<std::string>& names, const std::vector<double>& commands);

 private:
  struct Run {
    Run(const ExecutionOrder& asked, double machine_time_s)
        : order(asked), player(asked.policy, asked.start_values), heard_at_s(machine_time_s) {}

    const ExecutionOrder& order;
    PolicyPlayer player;
    RestDetector rest;
    std::optional<double> start_s;  // stamp of the first markers
    double now_s = 0.0;             // of the last
    double seen_s = 0.0;            // when a marker that cameras see was last reported
    double heard_at_s;              // when markers came last, of the machine's time
    double commanded_at_s = -std::numeric_limits<double>::infinity();  // when the last command was sent, machine time,
    double commanded_s = 0.0;                                          // and in session time
    bool sent = false;                                                 // the policy's last command
    bool heard = false;                                                // the last command, by simulated drives
    bool rested = false;
    bool cancelled = false;
    std::string fault;
    ExecutionReport report;

    double elapsed_s() const { return start_s ? now_s - *start_s : 0.0; }
  };

  // Empty where it was reached, else what came first.
  std::string wait(std::unique_lock<std::mutex>& lock, const std::function<bool()>& reached);
  std::string problem() const;
  std::string correct(std::unique_lock<std::mutex>& lock);
  std::string follow(std::unique_lock<std::mutex>& lock);
  bool may_correct(double after_s) const;
  bool follow_clock(double stamp_s);  // false where it jumped, which ends the run
  void play();
  bool too_early_for_motors() const;
  void go_on_along_path(const std::vector<Eigen::Vector3d>& positions_m);
  void repeat();
  void send(const std::vector<std::string>& names, const std::vector<double>& values);
  void look_at_motors();

  ClosedLoopOptions loop_options_;
  ExecutionHost host_;
  mutable std::mutex mutex_;  // guards what follows; held briefly
  std::condition_variable changed_;
  std::optional<Run> run_;
  std::optional<FollowedPath> followed_;
  MotorWatch motors_;
  bool drives_report_ = false;
  MeasuredRest measured_rest_;
};

}  // namespace soft_robot_lab
