// SPDX-License-Identifier: BSD-3-Clause
// Nodes of a whole session are killed or stopped in turn, and its clock is set: what is required of each stands in
// launch/README.md.
#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <future>
#include <iterator>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Clock.h>
#include <soft_robot_lab/ActuatorCommand.h>
#include <soft_robot_lab/ExecutePolicy.h>
#include <soft_robot_lab/MarkerObservations.h>
#include <soft_robot_lab/MotorState.h>
#include <soft_robot_lab/ShaftState.h>
#include <soft_robot_lab/ZeroMotors.h>
#include <visualization_msgs/MarkerArray.h>

#include "process_of.h"
#include "session_ears.h"
#include "ros/base/topics.h"

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;
using Status = diagnostic_msgs::DiagnosticStatus;

constexpr double patience_s = 60.0;

pid_t parent_of(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string text((std::istreambuf_iterator<char>(file)), {});
  std::istringstream words(text.substr(std::min(text.size(), text.rfind(')') + 1)));
  std::string state;
  pid_t parent = -1;
  words >> state >> parent;
  return parent;
}

// A program of this session that is no node: roslaunch gives it a name too.
pid_t program_of(const std::string& name) {
  const pid_t launcher = parent_of(process_of("/simulator"));
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const pid_t process = std::atoi(entry.path().filename().c_str());
    if (process <= 0 || parent_of(process) != launcher) continue;
    std::ifstream file(entry.path() / "cmdline");
    const std::string line((std::istreambuf_iterator<char>(file)), {});
    if (line.find("__name:=" + name + '\0') != std::string::npos) return process;
  }
  throw std::runtime_error("there is no process of " + name);
}

pid_t any_process_of(const std::string& name) {
  return name == "rig_emulator" ? program_of(name) : process_of("/" + name);
}

class SessionFaults : public testing::Test {
 protected:
  SessionFaults() {
    const ros::NodeHandle parameters("~");
    emulated_ = parameters.param<bool>("emulated", false);
    bags_ = parameters.param<std::string>("bags", "");
    shift_ = parameters.param<std::string>("shift", "");
    listen<diagnostic_msgs::DiagnosticArray>("/diagnostics", [this](const auto& m) { hear_diagnostics(m); });
    count<MarkerObservations>(topics::simulator_markers);
    count<MarkerObservations>(topics::tracker_markers);
    count<visualization_msgs::MarkerArray>(topics::overlay);
    if (!emulated_) return;
    count<MarkerObservations>(topics::plant_markers);
    count<ShaftState>(topics::rig_shafts);
    listen<MotorState>(topics::motor_state, [this](const MotorState& m) {
      motors_ = m;
      ++heard_[topics::motor_state];
    });
    heard_[topics::motor_state] = 0;
  }

  // Recordings and the clock's file are this test's.
  static void TearDownTestSuite() {
    const ros::NodeHandle parameters("~");
    std::error_code ignored;
    fs::remove_all(parameters.param<std::string>("bags", ""), ignored);
    fs::remove(parameters.param<std::string>("shift", ""), ignored);
  }

  template <typename Message>
  void listen(const std::string& topic, const std::function<void(const Message&)>& heard) {
    subscribers_.push_back(node_.subscribe<Message>(
        topic, 10, boost::function<void(const typename Message::ConstPtr&)>([heard](const auto& m) { heard(*m); })));
  }

  template <typename Message>
  void count(const std::string& topic) {
    heard_[topic] = 0;
    listen<Message>(topic, [this, topic](const Message&) { ++heard_[topic]; });
  }

  void hear_diagnostics(const diagnostic_msgs::DiagnosticArray& array) {
    for (const Status& status : array.status) {
      if (status.name.find("session_watch: session") == std::string::npos) continue;
      lamp_ = status;
      ++lamps_;
    }
  }

  std::string lamp_value(const std::string& key) const {
    for (const auto& value : lamp_.values)
      if (value.key == key) return value.value;
    return "";
  }

  bool lamp_says(const std::string& words) const { return lamp_.message.find(words) != std::string::npos; }

  // Everything slips, and the lamp, asked anew, has nothing to say but that the disk may be small.
  void expect_flows(const std::string& after) {
    for (auto& [topic, count] : heard_) count = 0;
    lamps_ = 0;
    const auto slips = [this] {
      for (const auto& [topic, count] : heard_)
        if (count < 3) return false;
      return lamps_ >= 2 && !lamp_says("not running") && !lamp_says("not started") && !lamp_says("nothing was written");
    };
    const bool all = spin_until(slips, patience_s);
    EXPECT_TRUE(all) << "after " << after << ": " << lamp_.message;
    for (const auto& [topic, count] : heard_) EXPECT_GE(count, 3) << topic << " after " << after;
    if (!emulated_) return;
    EXPECT_TRUE(spin_until([this] { return motors_.linked; }, patience_s)) << after;
  }

  // A policy is played to its end: all that moves the robot works together.
  void expect_plays(double right, const std::string& after) {
    if (emulated_ && !std::all_of(motors_.known.begin(), motors_.known.end(), [](auto known) { return known != 0; })) {
      EXPECT_TRUE(ask<ZeroMotors>(node_, topics::motor_zero).success) << after;
    }
    ExecutePolicy::Response answer;
    for (int attempt = 0; attempt < 3 && !answer.success; ++attempt) answer = finish(pull(right, 0.5));
    EXPECT_TRUE(answer.success) << answer.message << " after " << after;
  }

  std::future<ExecutePolicy::Response> pull(double right, double time_s) {
    ExecutePolicy::Request request;
    request.policy.names = {"left", "right"};
    request.policy.steps.resize(1);
    request.policy.steps[0].time_s = time_s;
    request.policy.steps[0].values = {1.0, right};
    request.time_limit_s = 60.0;
    return std::async(std::launch::async,
                      [this, request] { return ask<ExecutePolicy>(node_, topics::execute_policy, request); });
  }

  ExecutePolicy::Response finish(std::future<ExecutePolicy::Response> answer) {
    const auto ready = [&] { return answer.wait_for(std::chrono::seconds(0)) == std::future_status::ready; };
    EXPECT_TRUE(spin_until(ready, patience_s));
    return answer.get();
  }

  int restarts(const std::string& node) const {
    const std::string count = lamp_value(node + " started again");
    return count.empty() ? -1 : std::stoi(count);
  }

  std::vector<fs::path> bags() const {
    std::vector<fs::path> found;
    std::error_code none;
    for (const auto& file : fs::directory_iterator(bags_, none)) found.push_back(file.path());
    return found;
  }

  void end_and_await(const std::string& node, int signal) {
    const pid_t killed = process_of("/" + node);
    const int before = restarts(node);
    ASSERT_EQ(kill(killed, signal), 0);
    if (before < 0) {  // nothing counts its starts
      EXPECT_TRUE(spin_until([&] { return process_of("/" + node) != killed; }, patience_s));
    } else {
      EXPECT_TRUE(spin_until([&] { return restarts(node) == before + 1; }, patience_s)) << node << lamp_.message;
    }
    expect_flows("the end of " + node);
  }

  // Each node that the session starts again.
  void expect_all_come_back(int signal) {
    expect_flows("the start");
    // The recorder runs before it opens its bag.
    ASSERT_TRUE(spin_until([this] { return !bags().empty(); }, patience_s));
    const auto before = bags();
    std::vector<std::string> nodes = {"overlay", "controller", "recorder", "session_watch", "design"};
    if (emulated_) nodes.insert(nodes.end(), {"motor", "emulated_rig"});
    for (const std::string& node : nodes) end_and_await(node, signal);
    expect_plays(0.97, "the end of each");
    const auto after = bags();
    EXPECT_EQ(after.size(), before.size() + 1) << "another part";
    // rosbag ends its bag before it follows SIGTERM.
    for (fs::path bag : before)
      EXPECT_TRUE(fs::exists(signal == SIGTERM ? bag.replace_extension() : bag)) << bag << " was overwritten";
  }

  void stop_for_5_s(const std::vector<std::string>& nodes) {
    std::map<std::string, pid_t> stopped;
    for (const std::string& node : nodes) stopped[node] = any_process_of(node);
    std::string names;
    for (const auto& [node, process] : stopped) {
      EXPECT_EQ(kill(process, SIGSTOP), 0);
      names += " " + node;
    }
    const ros::SteadyTime begin = ros::SteadyTime::now();
    spin_until([&] { return (ros::SteadyTime::now() - begin).toSec() >= 5.0; }, patience_s);
    const std::string said = lamp_.message;
    for (const auto& [node, process] : stopped) {
      EXPECT_EQ(kill(process, SIGCONT), 0);
      if (is_watched(node) && stopped.count("session_watch") == 0) {
        EXPECT_NE(said.find(node + ": not running since"), std::string::npos) << said;
      }
    }
    expect_flows("stopping" + names);
    for (const auto& [node, process] : stopped) EXPECT_EQ(any_process_of(node), process) << "must not end";
  }

  // No node may end: who waits for its answer would get none.
  void set_clock_and_await(std::int64_t to_s, const std::string& after) {
    std::map<std::string, pid_t> running;
    for (const std::string node : {"overlay", "controller"}) running[node] = process_of("/" + node);
    set_clock(to_s);
    expect_flows(after);
    for (const auto& [node, process] : running)
      EXPECT_EQ(process_of("/" + node), process) << node << " after " << after;
  }

  bool is_watched(const std::string& node) const { return restarts(node) >= 0; }

  void set_clock(std::int64_t to_s) {
    const std::int64_t shift_s = to_s - static_cast<std::int64_t>(std::time(nullptr));
    std::fstream(shift_, std::ios::in | std::ios::out | std::ios::binary)
        .write(reinterpret_cast<const char*>(&shift_s), sizeof shift_s);
  }

  bool emulated_ = false;
  std::string bags_, shift_;
  std::map<std::string, int> heard_;
  Status lamp_;
  int lamps_ = 0;
  MotorState motors_;
  ros::NodeHandle node_;
  std::vector<ros::Subscriber> subscribers_;
};

TEST_F(SessionFaults, KilledNodesComeBackAndTheLampSaysSo) { expect_all_come_back(SIGKILL); }
TEST_F(SessionFaults, TerminatedNodesComeBackAndTheLampSaysSo) { expect_all_come_back(SIGTERM); }

TEST_F(SessionFaults, StoppedNodesGoOn) {
  expect_flows("the start");
  std::vector<std::vector<std::string>> groups = {
      {"simulator"}, {"cameras", "overlay", "recorder"}, {"tracker", "controller", "session_watch"}};
  if (emulated_)
    groups = {{"rig_emulator"},     {"motor", "tracker"},        {"emulated_rig", "recorder"},
              {"plant", "overlay"}, {"simulator", "controller"}, {"cameras", "session_watch"}};
  for (const auto& group : groups) stop_for_5_s(group);
  expect_plays(0.97, "stopping all");
}

// The machine's clock, which an emulated session runs by.
TEST_F(SessionFaults, ClockOfTheMachineMayBeSet) {
  expect_flows("the start");
  const std::int64_t now_s = std::time(nullptr);
  for (const std::int64_t to_s : {std::int64_t{0}, std::int64_t{4000000000}, now_s}) {
    const std::string what = "setting the clock to " + std::to_string(to_s);
    set_clock_and_await(to_s, what);
    expect_plays(to_s == 0 ? 0.97 : 0.98, what);
  }
}

TEST_F(SessionFaults, ClockThatIsSetStopsThePolicyThatIsPlayed) {
  if (!emulated_) GTEST_SKIP() << "a simulated session runs by its own clock";
  expect_flows("the start");
  auto answer = pull(0.95, 50.0);
  int commands = 0;
  listen<ActuatorCommand>(topics::actuator_command, [&](const ActuatorCommand&) { ++commands; });
  ASSERT_TRUE(spin_until([&] { return commands > 5; }, patience_s));
  set_clock(4000000000);
  const auto stopped = finish(std::move(answer));
  EXPECT_FALSE(stopped.success);
  EXPECT_NE(stopped.message.find("the clock was set by"), std::string::npos) << stopped.message;
  subscribers_.pop_back();
  set_clock_and_await(std::time(nullptr), "setting the clock back");
  expect_plays(0.98, "setting the clock back");
}

// Somebody else's /clock beside the simulator's.
TEST_F(SessionFaults, ClockOfTheSessionMayJump) {
  if (emulated_) GTEST_SKIP() << "an emulated session has no clock of its own";
  expect_flows("the start");
  ros::Publisher intruder = node_.advertise<rosgraph_msgs::Clock>("/clock", 100);
  for (const double to_s : {0.0, 4.0e9, 0.0}) {
    rosgraph_msgs::Clock clock;
    clock.clock = ros::Time(to_s);
    int heard = 0;
    spin_until(
        [&] {
          intruder.publish(clock);
          return ++heard == 300;
        },
        patience_s);
    expect_flows("a clock of " + std::to_string(to_s));
  }
  intruder.shutdown();
  expect_plays(0.97, "a clock that jumped");
}

}  // namespace
}  // namespace soft_robot_lab
