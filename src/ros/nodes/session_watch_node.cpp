// SPDX-License-Identifier: BSD-3-Clause
#include <ctime>
#include <string>
#include <vector>

#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_srvs/SetBool.h>

#include "read_parameter.h"
#include "run_node.h"
#include "ros/base/node_process.h"
#include "ros/recording/recorder_process.h"
#include "ros/recording/session_watch.h"
#include "ros/base/node_diagnosis.h"
#include "ros/base/log_text.h"
#include "ros/base/topics.h"

namespace soft_robot_lab {
namespace {

constexpr const char* kSessionWatchAbout =
    R"(Watches over a session: says in /diagnostics, as `session`, whether its nodes run
and its recording grows, or since when not, and whether the disk is nearly full. Its service session/record starts and
stops a recording of its own, as the panel's Record asks.

Parameters: ~nodes (list of names: those that the session starts again where they end), ~recorder (name; absent:
nothing is recorded from the start), ~bag_folder (where it records), ~robot (in the names of bags), ~record_images
(what cameras see too).)";

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
      : recorder_(text_parameter(parameters, "recorder")),
        bag_folder_(text_parameter(parameters, "bag_folder")),
        robot_(text_parameter(parameters, "robot", "session")) {
    read_parameter(parameters, "record_images", images_);
    std::vector<std::string> names;
    read_parameter(parameters, "nodes", names);
    for (const std::string& name : names) nodes_.emplace_back(name);
    if (!recorder_.empty()) nodes_.emplace_back(recorder_);
    recording_publisher_ = ros::NodeHandle().advertise<std_msgs::Bool>(topics::session_recording, 1, true);
    publish_recording();
    if (!bag_folder_.empty())
      service_ = ros::NodeHandle().advertiseService(topics::session_record, &SessionWatchNode::record, this);
    diagnosis_.add("session", [this](auto& status) { diagnose(status); });
    diagnosis_.start();
  }

 private:
  void diagnose(NodeDiagnosis::Status& status) {
    const Moment now = present();
    Finding all;
    for (NodeWatch& node : nodes_) {
      const auto process = answering_process(ros::names::resolve(node.name()), longest_answer_s);
      all = worst_of(all, node.update(now, process));
      status.add(node.name() + " started again",
                 std::to_string(node.restarts()) + (node.restarts() == 0 ? "" : ", last at " + node.last_restart()));
      if (node.name() != recorder_) continue;
      const BagSight bag = look_at_bag(process, bag_folder_);
      all = worst_of(worst_of(all, recording_.update(now, bag)), place_of(bag, bag_folder_));
      status.add("bag", bag.path);
      status.add("bag size [MB]", static_cast<double>(bag.bytes) / 1048576.0);
      status.add("free space [MB]", static_cast<double>(bag.free_bytes.value_or(0)) / 1048576.0);
    }
    all = worst_of(all, asked_recording(now, status));
    using Status = diagnostic_msgs::DiagnosticStatus;
    status.summary(all.level == Finding::Level::ok        ? Status::OK
                   : all.level == Finding::Level::warning ? Status::WARN
                                                          : Status::ERROR,
                   all.text);
    log(all);
  }

  Finding asked_recording(const Moment& now, NodeDiagnosis::Status& status) {
    publish_recording();
    if (asked_.ended_by_itself())
      return {Finding::Level::error, "recording: the recorder ended by itself; press Record"};
    const std::optional<pid_t> process = asked_.process();
    if (!process) return {};
    const BagSight bag = look_at_bag(process, bag_folder_);
    status.add("asked bag", bag.path);
    return worst_of(asked_bag_.update(now, bag), place_of(bag, bag_folder_));
  }

  void publish_recording() {
    std_msgs::Bool recording;
    recording.data = !recorder_.empty() || asked_.process().has_value();
    if (told_ == static_cast<int>(recording.data)) return;
    told_ = static_cast<int>(recording.data);
    recording_publisher_.publish(recording);
  }

  bool record(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response) {
    try {
      if (!recorder_.empty()) throw std::runtime_error("the session records until its end (record:=true)");
      response.message = request.data ? start_recording() : stop_recording();
      response.success = true;
    } catch (const std::exception& error) {
      response.message = answer_text(error);
    }
    publish_recording();
    return true;
  }

  std::string start_recording() {
    if (const Finding place = place_of({}, bag_folder_); place.level != Finding::Level::ok)
      throw std::runtime_error(place.text);
    asked_.start({"rosrun", "soft_robot_lab", "record.sh", bag_folder_, robot_, images_ ? "true" : "false"});
    asked_bag_ = {};
    return "records into " + bag_folder_;
  }

  std::string stop_recording() {
    const std::optional<pid_t> process = asked_.process();
    if (!process) throw std::runtime_error("nothing is recorded");
    std::string path = look_at_bag(process, bag_folder_).path;
    const bool began = !path.empty();
    if (!asked_.stop(longest_closing_s)) return (began ? path : "the bag") + std::string(" is still being written");
    if (!began) return "ended before anything was recorded";
    const std::size_t ending = path.rfind(".active");
    return "recorded " + path.substr(0, ending);
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

  static constexpr double longest_answer_s = 0.5, longest_closing_s = 10.0;
  std::string recorder_, bag_folder_, robot_, logged_;
  bool images_ = false;
  int told_ = -1;          // what was last said of the recording
  RecorderProcess asked_;  // by the service
  BagWatch asked_bag_;
  std::vector<NodeWatch> nodes_;
  BagWatch recording_;
  NodeDiagnosis diagnosis_{"session"};
  ros::Publisher recording_publisher_;
  ros::ServiceServer service_;
};

}  // namespace

int session_watch_node(int argc, char** argv) {
  return run_node(argc, argv, "session_watch", kSessionWatchAbout, [] {
    SessionWatchNode node(ros::NodeHandle("~"));
    ros::spin();
  });
}

}  // namespace soft_robot_lab
