// SPDX-License-Identifier: BSD-3-Clause
// Two sessions in two namespaces under one master: each robot has its topics, services, frames and lamp, and is moved
// alone. A third session that would take the place of one is refused, and that one goes on.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <soft_robot_lab/ExecutePolicy.h>
#include <soft_robot_lab/OptimisePolicy.h>
#include <std_msgs/String.h>
#include <tf2/buffer_core.h>

#include "process_of.h"
#include "ros/messages/conversions.h"
#include "ros/base/frame_listener.h"
#include "ros/base/topics.h"
#include "session_ears.h"

namespace soft_robot_lab {
namespace {

constexpr double patience_s = 60.0;

// What one session says of its robot.
class SessionEar {
 public:
  explicit SessionEar(const std::string& name) : name_(name), node_(name) {
    states_ = node_.subscribe<ActuatorState>(
        topics::simulator_actuators, 10,
        boost::function<void(const ActuatorState::ConstPtr&)>([this](const auto& m) { commands_ = m->commands; }));
    markers_ = node_.subscribe<MarkerObservations>(
        topics::simulator_markers, 10,
        boost::function<void(const MarkerObservations::ConstPtr&)>([this](const auto& m) {
          frame_ = m->header.frame_id;
          tip_m_ = position_of(*m, "tip");
        }));
  }

  const std::string& name() const { return name_; }
  ros::NodeHandle& node() { return node_; }
  const std::vector<double>& commands() const { return commands_; }
  const Eigen::Vector3d& tip_m() const { return tip_m_; }
  const std::string& frame() const { return frame_; }

 private:
  std::string name_, frame_;
  ros::NodeHandle node_;
  ros::Subscriber states_, markers_;
  std::vector<double> commands_;
  Eigen::Vector3d tip_m_ = Eigen::Vector3d::Zero();
};

class TwoSessions : public testing::Test {
 protected:
  void SetUp() override {
    for (SessionEar* session : {&left_, &right_})
      ASSERT_TRUE(spin_until([&] { return session->commands().size() == 2 && !session->frame().empty(); }, patience_s))
          << session->name();
  }

  SessionEar left_{"left"}, right_{"right"};
};

TEST_F(TwoSessions, SimulateRobotsOfTheirOwn) {
  EXPECT_NE(hear<std_msgs::String>(left_.node(), topics::simulator_scene)->data.find("cable_bar.yaml"),
            std::string::npos);
  EXPECT_NE(hear<std_msgs::String>(right_.node(), topics::simulator_scene)->data.find("cable_bar_soft.yaml"),
            std::string::npos);
}

TEST_F(TwoSessions, MoveOneRobotAndLeaveTheOther) {
  const std::vector<double> before = right_.commands();
  const Eigen::Vector3d tip_before_m = right_.tip_m(), left_before_m = left_.tip_m();
  ros::Publisher commands = left_.node().advertise<ActuatorCommand>(topics::actuator_command, 1, true);
  ActuatorCommand command;
  command.names = {"left"};
  command.values = {0.9};
  commands.publish(command);
  ASSERT_TRUE(spin_until([&] { return left_.commands()[0] == 0.9; }, patience_s));
  ASSERT_TRUE(spin_until([&] { return (left_.tip_m() - left_before_m).norm() > 2e-3; }, patience_s));
  EXPECT_EQ(right_.commands(), before);
  EXPECT_LT((right_.tip_m() - tip_before_m).norm(), 1e-4) << "it only comes to rest";
}

TEST_F(TwoSessions, FindAndPlayAPolicyForOneRobot) {
  const std::vector<double> before = left_.commands();
  OptimisePolicy::Request request;
  request.method = "gauss_newton";
  request.marker = "tip";
  request.target = to_message(Eigen::Vector3d(0.02, 0.0, -0.095));
  const auto found = ask<OptimisePolicy>(right_.node(), right_.node().resolveName(topics::optimise_policy), request);
  ASSERT_TRUE(found.success) << found.message;
  const auto played = ask<ExecutePolicy>(right_.node(), right_.node().resolveName(topics::execute_policy));
  EXPECT_TRUE(played.success) << played.message;
  EXPECT_TRUE(spin_until([&] { return std::abs(right_.tip_m().x() - 0.02) < 2e-3; }, patience_s));
  EXPECT_EQ(left_.commands(), before);
}

TEST_F(TwoSessions, StandBesideOneAnotherInOneTreeOfFrames) {
  EXPECT_EQ(left_.frame(), "left/robot_base");
  EXPECT_EQ(right_.frame(), "right/robot_base");
  tf2::BufferCore frames;
  const FrameListener listener(frames);
  const auto knows = [&](const std::string& frame) { return frames.canTransform("world", frame, ros::Time()); };
  for (const char* frame : {"left/robot_base", "right/robot_base", "left/simulated/tip", "right/simulated/tip"})
    ASSERT_TRUE(spin_until([&] { return knows(frame); }, patience_s)) << frame;
  const auto place = frames.lookupTransform("left/robot_base", "right/robot_base", ros::Time()).transform.translation;
  EXPECT_NEAR(place.x, 0.2, 1e-12);
  EXPECT_NEAR(place.y, 0.0, 1e-12);
  EXPECT_NEAR(place.z, 0.0, 1e-12);
}

TEST_F(TwoSessions, ShowGreenLampsOfTheirOwn) {
  std::map<std::string, int> levels;
  const ros::Subscriber diagnoses = left_.node().subscribe<diagnostic_msgs::DiagnosticArray>(
      "/diagnostics", 100, boost::function<void(const diagnostic_msgs::DiagnosticArray::ConstPtr&)>([&](const auto& m) {
        for (const auto& status : m->status) levels[status.name] = status.level;
      }));
  for (const char* name : {"left/session_watch: session", "right/session_watch: session"})
    EXPECT_TRUE(spin_until(
        [&] { return levels.count(name) > 0 && levels[name] == diagnostic_msgs::DiagnosticStatus::OK; }, patience_s))
        << name;
}

// By roslaunch, as a user would start it.
TEST_F(TwoSessions, RefuseAThirdInTheirPlace) {
  const std::vector<std::string> nodes = {"simulator", "controller", "overlay", "recorder", "session_watch"};
  const auto processes = [&] {
    std::vector<pid_t> all;
    std::transform(nodes.begin(), nodes.end(), std::back_inserter(all),
                   [](const std::string& node) { return process_of("/left/" + node); });
    return all;
  };
  const std::vector<pid_t> before = processes();
  const std::string bags = ros::NodeHandle("~").param<std::string>("bags", ""), said = bags + "_third.log";
  const int status =
      std::system(("ROS_NAMESPACE=left timeout 100 roslaunch soft_robot_lab session.launch robot:=hammerbot "
                   "wall_clock:=true rviz:=false record:=true bag_folder:=" +
                   bags + "_third >" + said + " 2>&1")
                      .c_str());
  EXPECT_NE(WEXITSTATUS(status), 124) << "it ran on";
  std::ifstream log(said);
  const std::string text((std::istreambuf_iterator<char>(log)), {});
  EXPECT_NE(text.find("/left/simulator runs already, as process " + std::to_string(before[0])), std::string::npos)
      << text;
  EXPECT_EQ(processes(), before);
  EXPECT_NE(hear<std_msgs::String>(left_.node(), topics::simulator_scene)->data.find("cable_bar.yaml"),
            std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(bags + "_third")) << "it recorded";
}

}  // namespace
}  // namespace soft_robot_lab
