// SPDX-License-Identifier: BSD-3-Clause
// soak_check SECONDS: commands a running simulated session once a second for so long, and holds what its nodes take and
// how fast they answer to limits: memory that does not grow, markers that keep their period, commands that are heard at
// once. Status 1 where one does not hold.
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "ros/process_of.h"
#include "ros/session_ears.h"
#include "ros/messages/messages.h"
#include "ros/base/topics.h"
#include "settings/quantile.h"

namespace soft_robot_lab {
namespace {

constexpr double kGrowth = 0.02;       // of resident memory, from the first to the last tenth
constexpr double kPeriodError = 0.02;  // of the markers' period, their mean, by the wall's clock
constexpr double kLatency_s = 0.05;    // from a command to the state that has it, the median
constexpr double kWorstLatency_s = 0.5;
const std::vector<std::string> kNodes = {"/simulator", "/controller", "/overlay"};

double resident_bytes(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/statm");
  double pages = 0.0, resident = 0.0;
  if (!(file >> pages >> resident)) throw std::runtime_error("process " + std::to_string(process) + " is gone");
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

double mean(const std::vector<double>& values, std::size_t from, std::size_t to) {
  const auto begin = values.begin();
  return std::accumulate(begin + static_cast<std::ptrdiff_t>(from), begin + static_cast<std::ptrdiff_t>(to), 0.0) /
         static_cast<double>(to - from);
}

class Soak {
 public:
  Soak() {
    commands_ = node_.advertise<ActuatorCommand>(topics::actuator_command, 10, true);
    subscribers_ = {node_.subscribe(topics::simulator_markers, 1000, &Soak::on_markers, this),
                    node_.subscribe(topics::simulator_actuators, 1000, &Soak::on_actuators, this)};
    for (const std::string& node : kNodes) processes_[node] = process_of(node);
    if (!spin_until([this] { return last_ && !name_.empty(); }, 60.0))
      throw std::runtime_error("no session sends markers and actuators");
    // Others listen for commands too, so the number of subscribers does not show whether the simulator is one.
    for (int tries = 0; tries == 0 || (asked_ && tries < 300); ++tries) {
      send(0.99);
      spin_until([this] { return !asked_; }, 0.2);
    }
    latencies_s_.clear();
  }

  void run(double duration_s) {
    const double warm_s = std::min(60.0, 0.2 * duration_s);
    const double start_s = ros::WallTime::now().toSec();
    for (int second = 0; second < duration_s; ++second) {
      send(second % 2 == 0 ? 0.97 : 1.0);
      while (ros::ok() && ros::WallTime::now().toSec() < start_s + second + 1) {
        ros::spinOnce();
        ros::WallDuration(0.001).sleep();
      }
      if (asked_)
        throw std::runtime_error("the command of second " + std::to_string(second) + ", " + name_ + " to " +
                                 std::to_string(asked_->second) + ", was not heard within a second");
      if (!ros::ok()) throw std::runtime_error("the session ended");
      if (second < warm_s) continue;
      for (const auto& [node, process] : processes_) resident_[node].push_back(resident_bytes(process));
    }
  }

  bool holds() const {
    bool good = true;
    const auto check = [&](const std::string& what, double value, double most, const char* unit) {
      std::printf("%-40s %10.4f %s, at most %g: %s\n", what.c_str(), value, unit, most,
                  value <= most ? "holds" : "DOES NOT HOLD");
      good = good && value <= most;
    };
    for (const auto& [node, resident] : resident_) {
      const std::size_t tenth = std::max<std::size_t>(1, resident.size() / 10);
      const double before = mean(resident, 0, tenth), after = mean(resident, resident.size() - tenth, resident.size());
      std::printf("%-40s %10.1f MB\n", (node + " takes").c_str(), 1e-6 * after);
      check(node + " grows by", after / before - 1.0, kGrowth, "");
    }
    const double period_s = mean(wall_s_, 0, wall_s_.size()), told_s = mean(session_s_, 0, session_s_.size());
    check("markers' period is off by", std::abs(period_s / told_s - 1.0), kPeriodError, "");
    std::printf("%-40s %10.4f s, 99 %% below %.4f s\n", "their period", period_s, quantile(wall_s_, 0.99));
    check("a command is heard after", median(latencies_s_), kLatency_s, "s");
    check("the slowest after", quantile(latencies_s_, 1.0), kWorstLatency_s, "s");
    return good;
  }

 private:
  void on_markers(const MarkerObservations& markers) {
    const double wall_s = ros::WallTime::now().toSec(), session_s = markers.header.stamp.toSec();
    if (last_) {
      wall_s_.push_back(wall_s - last_->first);
      session_s_.push_back(session_s - last_->second);
    }
    last_ = {wall_s, session_s};
  }

  void on_actuators(const ActuatorState& actuators) {
    if (actuators.names.empty()) return;
    name_ = actuators.names.front();
    if (!asked_ || actuators.commands.front() != asked_->second) return;
    latencies_s_.push_back(ros::WallTime::now().toSec() - asked_->first);
    asked_.reset();
  }

  void send(double value) {
    ActuatorCommand command;
    command.names = {name_};
    command.values = {value};
    asked_ = {ros::WallTime::now().toSec(), value};
    commands_.publish(command);
  }

  ros::NodeHandle node_;
  ros::Publisher commands_;
  std::vector<ros::Subscriber> subscribers_;
  std::map<std::string, pid_t> processes_;
  std::map<std::string, std::vector<double>> resident_;  // once a second
  std::string name_;                                     // of an actuator
  std::optional<std::pair<double, double>> last_;        // when markers came last, and their stamp
  std::optional<std::pair<double, double>> asked_;       // when a command was sent that is not heard yet, and its value
  std::vector<double> wall_s_, session_s_, latencies_s_;  // between markers; from command to state
};

}  // namespace
}  // namespace soft_robot_lab

int main(int argc, char** argv) {
  const double duration_s = argc == 2 ? std::atof(argv[1]) : 0.0;
  if (!(duration_s >= 20.0 && duration_s <= 1e6)) {
    std::fputs("usage: soak_check SECONDS, from 20 on\n", stderr);
    return 2;
  }
  ros::init(argc, argv, "soak_check");
  try {
    soft_robot_lab::Soak soak;
    soak.run(duration_s);
    return soak.holds() ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
