// SPDX-License-Identifier: BSD-3-Clause
// Drives a session through an experiment's configurations in their order, as the tables 6.4 to 6.6 of the thesis, waits
// for rest at each, and prints how large the gap between robot and simulation is there.
//
// Usage: run_table_node EXPERIMENT.yaml [HOLD_S]. Each configuration is held for 3 s, or as long as is asked for:
// silicone creeps, and a fit takes the end of a hold. Exit status: 0 done, 1 a part failed, 2 bad file or arguments.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <soft_robot_lab/ActuatorRanges.h>
#include <soft_robot_lab/ActuatorState.h>
#include <soft_robot_lab/ExecutePolicy.h>
#include <soft_robot_lab/RealityGap.h>

#include "control/configuration_table.h"
#include "require_master.h"
#include "session_client.h"
#include "settings/command_line.h"
#include "settings/require_in_range.h"
#include "ros/base/stamps.h"
#include "ros/base/topics.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

constexpr double ramp_s = 1.0, usual_hold_s = 3.0, longest_hold_s = 600.0;
constexpr int least_gaps = 3;
constexpr double timeout_s = 10.0;  // for so many

// Root mean square of all gaps heard while the robot rests.
class RestingGap {
 public:
  explicit RestingGap(ros::NodeHandle& node)
      : subscriber_(node.subscribe(topics::reality_gap, 100, &RestingGap::add, this)) {}

  // [m]; negative without a tracker.
  double during(double hold_s) {
    count_ = 0;
    sum_m2_ = 0.0;
    begin_ = ros::Time::now();
    for (double held_s = 0.0; ros::ok() && (held_s < hold_s || (count_ < least_gaps && held_s < hold_s + timeout_s));
         held_s = seconds_between(begin_, ros::Time::now()))
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.05));
    return count_ > 0 ? std::sqrt(sum_m2_ / count_) : -1.0;
  }

 private:
  void add(const RealityGap& gap) {
    if (gap.header.stamp < begin_) return;
    sum_m2_ += gap.rms_m * gap.rms_m;
    ++count_;
  }

  ros::Time begin_;
  int count_ = 0;
  double sum_m2_ = 0.0;
  ros::Subscriber subscriber_;
};

// In the scene's order, which is the table's.
ActuatorRanges actuators_of_session(ros::NodeHandle& node, std::size_t count) {
  const ActuatorRanges ranges = first_on<ActuatorRanges>(node, topics::simulator_ranges);
  if (ranges.names.size() != count)
    throw std::invalid_argument("the session's robot has " + std::to_string(ranges.names.size()) +
                                " actuators, the table " + std::to_string(count));
  return ranges;
}

// Of cables by contraction, so that they are slack whatever the table pulled: paid out from a pull, a drive would stop
// short of its zero by its backlash. The others' at rest.
std::vector<double> slack_commands(const ActuatorRanges& ranges, const std::vector<CableState>& cables,
                                   const std::vector<Configuration>& table) {
  std::vector<double> commands = ranges.rests;
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const auto is_this = [&](const CableState& cable) { return cable.name == ranges.names[i]; };
    if (ranges.units[i] != "1" || std::none_of(cables.begin(), cables.end(), is_this)) continue;
    commands[i] = std::min(1.05, ranges.maxs[i]);
    for (const Configuration& configuration : table) commands[i] = std::max(commands[i], configuration.commands[i]);
  }
  return commands;
}

class TableRun {
 public:
  TableRun(const std::vector<Configuration>& table, double hold_s)
      : table_(table), hold_s_(hold_s), ranges_(actuators_of_session(node_, table.front().commands.size())) {}

  void run() {
    std::string heading;
    for (const std::string& name : ranges_.names)
      heading += name + std::string(name.size() < 6 ? 7 - name.size() : 1, ' ');
    std::printf("      %sat rest after   gap [mm rms]\n", heading.c_str());
    for (const Configuration& configuration : table_) {
      go_and_tell(configuration);
      if (!ros::ok()) throw std::runtime_error("the session ended");
    }
    return_to_rest();
  }

 private:
  ExecutePolicy::Response go(const std::vector<double>& values) {
    ExecutePolicy::Request request;
    request.policy.names = ranges_.names;
    request.policy.steps.resize(1);
    request.policy.steps[0].time_s = ramp_s;
    request.policy.steps[0].values = values;
    request.wait_until_rest = true;
    return call<ExecutePolicy>(node_, topics::execute_policy, request);
  }

  void go_and_tell(const Configuration& configuration) {
    const auto answer = go(configuration.commands);
    const double gap_m = gap_.during(hold_s_);
    std::printf("%-5s ", configuration.name.c_str());
    for (const double value : configuration.commands) std::printf("%-6g ", value);
    std::printf("%6.2f s", answer.duration_s);
    std::printf(gap_m < 0.0 ? "        no tracker\n" : "        %.3f\n", 1e3 * gap_m);
    std::fflush(stdout);
  }

  void return_to_rest() {
    const auto cables = first_on<ActuatorState>(node_, topics::simulator_actuators).cables;
    const std::vector<double> slack = slack_commands(ranges_, cables, table_);
    if (slack != ranges_.rests) go(slack);
    go(ranges_.rests);
  }

  std::vector<Configuration> table_;
  double hold_s_;
  ros::NodeHandle node_;
  RestingGap gap_{node_};
  ActuatorRanges ranges_;
};

int run_table(const std::string& experiment, double hold_s) {
  require_in_range("HOLD_S", hold_s, {0.0, longest_hold_s, true});
  const std::vector<Configuration> table = read_configurations(YamlNode::load_file(experiment));
  try {
    TableRun(table, hold_s).run();
    return kGood;
  } catch (const std::invalid_argument&) {
    throw;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return kNotGood;
  }
}

}  // namespace

int run_table_node(int argc, char** argv) {
  ros::init(argc, argv, "run_table");
  CommandLine app("Drives a session through an experiment's configurations, and prints the gap at each.",
                  "run_table_node");
  std::string experiment;
  double hold_s = usual_hold_s;
  app.add_option("EXPERIMENT", experiment, "an experiment's file").type_name("FILE").required();
  app.add_option("HOLD_S", hold_s, "for how long each is held: silicone creeps, and a fit takes the end of a hold")
      .type_name("S")
      .show_default();
  app.footer("Exit status: 0 done, 1 a part failed, 2 bad file or arguments.");
  return run_program(app, argc, argv, [&] {
    require_master();
    return run_table(experiment, hold_s);
  });
}

}  // namespace soft_robot_lab
