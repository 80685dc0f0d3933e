// SPDX-License-Identifier: BSD-3-Clause
#include <ctime>
#include <string>
#include <vector>

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/ros.h>

#include "run_node.h"
#include "ros/node_process.h"
#include "ros/session_watch.h"

namespace soft_robot_lab {
namespace {

constexpr const char* kAbout = R"(Watches over a session: says in /diagnostics, as `session`, whether its nodes run
and its recording grows, or since when not, and whether the disk is nearly full.

Parameters: ~nodes (list of names: those that the session starts again where they end), ~recorder (name; absent:
nothing is recorded), ~bag_folder (where it records).)";

Moment present() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char clock[32];
  std::strftime(clock, sizeof clock, "%H:%M:%S", &local);
  return {ros::SteadyTime::now().toSec(), clock};
}

class SessionWatchNode {
 public:
  explicit SessionWatchNode(const ros::NodeHandle& parameters)
      : recorder_(parameters.param<std::string>("recorder", "")),
        bag_folder_(parameters.param<std::string>("bag_folder", "")) {
    for (const std::string& name : parameters.param<std::vector<std::string>>("nodes", {})) nodes_.emplace_back(name);
    if (!recorder_.empty()) nodes_.emplace_back(recorder_);
    diagnostics_.setHardwareID("session");
    diagnostics_.add("session", this, &SessionWatchNode::diagnose);
    timer_ = ros::NodeHandle().createSteadyTimer(ros::WallDuration(1.0),
                                                 [this](const auto&) { diagnostics_.force_update(); });
  }

 private:
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
    const Moment now = present();
    Finding all;
    for (NodeWatch& node : nodes_) {
      const auto process = answering_process(ros::names::resolve(node.name()), longest_answer_s);
      all = worst_of(all, node.update(now, process));
      status.add(node.name() + " started again",
                 std::to_string(node.restarts()) + (node.restarts() == 0 ? "" : ", last at " + node.last_restart()));
      if (node.name() != recorder_) continue;
      const BagSight bag = look_at_bag(process, bag_folder_);
      all = worst_of(all, recording_.update(now, bag));
      status.add("bag", bag.path);
      status.add("bag size [MB]", static_cast<double>(bag.bytes) / 1048576.0);
      status.add("free space [MB]", static_cast<double>(bag.free_bytes.value_or(0)) / 1048576.0);
    }
    using Status = diagnostic_msgs::DiagnosticStatus;
    status.summary(all.level == Finding::Level::ok        ? Status::OK
                   : all.level == Finding::Level::warning ? Status::WARN
                                                          : Status::ERROR,
                   all.text);
    log(all);
  }

  void log(const Finding& finding) {
    if (finding.text == logged_) return;
    logged_ = finding.text;
    if (finding.level == Finding::Level::ok)
      ROS_INFO("%s", finding.text.c_str());
    else if (finding.level == Finding::Level::warning)
      ROS_WARN_THROTTLE(60.0, "%s", finding.text.c_str());  // the free space changes all the time
    else
      ROS_ERROR_THROTTLE(1.0, "%s", finding.text.c_str());
  }

  static constexpr double longest_answer_s = 0.5;
  std::string recorder_, bag_folder_, logged_;
  std::vector<NodeWatch> nodes_;
  BagWatch recording_;
  diagnostic_updater::Updater diagnostics_;
  ros::SteadyTimer timer_;
};

}  // namespace
}  // namespace soft_robot_lab

int main(int argc, char** argv) {
  using namespace soft_robot_lab;
  return run_node(argc, argv, "session_watch", kAbout, [] {
    const SessionWatchNode node(ros::NodeHandle("~"));
    ros::spin();
  });
}
