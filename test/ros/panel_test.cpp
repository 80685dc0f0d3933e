// SPDX-License-Identifier: BSD-3-Clause
// The panel moves a simulated bar: sliders, Reset, poses, targets, Execute and Stop, each by its keys. A key is pressed
// until it works, as the panel takes seconds to find a session's services; none of them does harm when it comes twice.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <future>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <geometry_msgs/PoseStamped.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <soft_robot_lab/ExecutePolicy.h>
#include <soft_robot_lab/OptimisePolicy.h>
#include <soft_robot_lab/OptimisePolicyResult.h>
#include <soft_robot_lab/UseSolver.h>
#include <std_msgs/Bool.h>
#include <std_msgs/String.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>
#include <sys/resource.h>
#include <visualization_msgs/InteractiveMarkerInit.h>
#include <visualization_msgs/Marker.h>

#include "hidden_rviz.h"
#include "process_of.h"
#include "ros/messages/conversions.h"
#include "ros/messages/frames.h"
#include "ros/base/machine_time.h"
#include "ros/panel/panel_link.h"
#include "ros/base/topics.h"
#include "ros/recording/recorded_topics.h"
#include "session_ears.h"
#include "settings/quantile.h"

namespace soft_robot_lab {
namespace {

constexpr double patience_s = 60.0;

class Panel : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    rviz_ = std::make_unique<HiddenRviz>(SOFT_ROBOT_LAB_SOURCE "/config/rviz/session.rviz");
  }
  static void TearDownTestSuite() { rviz_.reset(); }

  void SetUp() override {
    states_ = node_.subscribe<ActuatorState>(
        topics::simulator_actuators, 1, boost::function<void(const ActuatorState::ConstPtr&)>([this](const auto& m) {
          commands_ = m->commands;
          ++heard_;
        }));
    markers_ = node_.subscribe<MarkerObservations>(topics::simulator_markers, 1,
                                                   boost::function<void(const MarkerObservations::ConstPtr&)>(
                                                       [this](const auto& m) { tip_ = position_of(*m, "tip"); }));
    sent_by_rviz_ = node_.subscribe<ActuatorCommand>(
        topics::actuator_command, 100,
        boost::function<void(const ros::MessageEvent<const ActuatorCommand>&)>([this](const auto& event) {
          if (event.getPublisherName() == "/panel_rviz") ++sent_;
        }));
    ask<std_srvs::Trigger>(node_, topics::simulator_reset);
    ASSERT_TRUE(spin_until([&] { return at_rest_commands(); }, patience_s));
    rest_tip_ = tip_;
  }

  bool at_rest_commands() const { return commands_ == std::vector<double>{1.0, 1.0} && tip_.norm() > 0.0; }

  template <typename Condition>
  bool press_until(const std::string& keys, const Condition& condition, double every_s = 5.0) {
    const ros::WallTime limit = ros::WallTime::now() + ros::WallDuration(patience_s);
    while (ros::WallTime::now() < limit) {
      rviz_->press(keys);
      if (spin_until(condition, every_s)) return true;
    }
    return false;
  }

  void hear_more_states(int count) {
    const int before = heard_;
    ASSERT_TRUE(spin_until([&] { return heard_ >= before + count; }, patience_s));
  }

  static std::unique_ptr<HiddenRviz> rviz_;
  ros::NodeHandle node_;
  ros::Subscriber states_, markers_, sent_by_rviz_;
  std::vector<double> commands_ = {0.0, 0.0};
  Eigen::Vector3d tip_ = Eigen::Vector3d::Zero(), rest_tip_;
  int heard_ = 0, sent_ = 0;
};
std::unique_ptr<HiddenRviz> Panel::rviz_;

// For the tip.
OptimisePolicy::Request endless_search(const Eigen::Vector3d& target_m) {
  OptimisePolicy::Request request;
  request.method = "cma_es";
  request.marker = "tip";
  request.target = to_message(target_m);
  request.max_iterations = 100000;
  request.tolerance_m = 1e-9;
  return request;
}

TEST_F(Panel, MovesTheRobotByASliderAndBack) {
  ASSERT_TRUE(press_until("alt+1 Next", [&] { return commands_[0] < 0.95; }));
  EXPECT_EQ(commands_[1], 1.0);
  EXPECT_TRUE(spin_until([&] { return (tip_ - rest_tip_).norm() > 2e-3; }, patience_s));
  ASSERT_TRUE(press_until("alt+1 Prior", [&] { return commands_[0] == 1.0; }));  // exactly: shown is sent
  EXPECT_TRUE(spin_until([&] { return (tip_ - rest_tip_).norm() < 5e-4; }, patience_s));
}

TEST_F(Panel, SendsNothingForWhatOthersCommand) {
  ASSERT_TRUE(press_until("alt+1 Next", [&] { return commands_[0] < 0.95; }));  // it is connected
  hear_more_states(50);
  const int before = sent_;
  ros::Publisher publisher = node_.advertise<ActuatorCommand>(topics::actuator_command, 1, true);
  ActuatorCommand command;
  command.names = {"left", "right"};
  command.values = {0.98765432, 0.9};
  publisher.publish(command);
  ASSERT_TRUE(spin_until([&] { return commands_ == command.values; }, patience_s));
  hear_more_states(300);
  EXPECT_EQ(sent_, before);
  EXPECT_EQ(commands_, command.values);
}

TEST_F(Panel, ResetsTheRobot) {
  ASSERT_TRUE(press_until("alt+2 Home", [&] { return commands_[1] < 0.9; }));
  EXPECT_TRUE(press_until("alt+r", [&] { return at_rest_commands(); }));
}

TEST_F(Panel, StoresAPoseAndPlaysIt) {
  ASSERT_TRUE(press_until("alt+2 Next", [&] { return commands_[1] < 0.95; }));
  hear_more_states(20);
  const std::vector<double> pose = commands_;
  rviz_->press("alt+t");
  ASSERT_TRUE(press_until("alt+r", [&] { return at_rest_commands(); }));
  EXPECT_TRUE(press_until("alt+y", [&] { return commands_ == pose; }));
  std::ifstream kept(rviz_->home() + "/soft_robot_lab/poses.txt");
  std::string line;
  EXPECT_TRUE(std::getline(kept, line)) << "in the user's folder";
  EXPECT_NE(line.find("cable_bar.yaml"), std::string::npos) << line;
}

TEST_F(Panel, ExecutesWhatWasFoundForAPoseAndShowsItsGhostBefore) {
  int action = -1;
  const ros::Subscriber ghosts = node_.subscribe<visualization_msgs::Marker>(
      topics::controller_ghost, 10,
      boost::function<void(const visualization_msgs::Marker::ConstPtr&)>([&](const auto& m) { action = m->action; }));
  ros::Publisher goals = node_.advertise<geometry_msgs::PoseStamped>(topics::controller_goal, 1, true);
  geometry_msgs::PoseStamped goal;
  goal.header.frame_id = room_frame;
  goal.pose.position = to_message(Eigen::Vector3d(0.02, 0.0, -0.095));
  goals.publish(goal);
  ASSERT_TRUE(spin_until([&] { return action == visualization_msgs::Marker::ADD; }, patience_s));
  EXPECT_EQ(commands_, (std::vector<double>{1.0, 1.0}));
  const auto is_there = [&] { return std::abs(tip_.x() - 0.02) < 1e-3; };
  EXPECT_TRUE(press_until("alt+e", is_there));
  EXPECT_TRUE(spin_until([&] { return action == visualization_msgs::Marker::DELETE; }, patience_s));
}

// The ghost has the target in its tip then: what it covers is taken hold of all the same.
TEST_F(Panel, DragsTheTargetInsideItsGhost) {
  bool ghost = false;
  std::optional<Eigen::Vector3d> target_m;
  const ros::Subscriber ghosts = node_.subscribe<visualization_msgs::Marker>(
      topics::controller_ghost, 10,
      boost::function<void(const visualization_msgs::Marker::ConstPtr&)>(
          [&](const auto& m) { ghost = m->action == visualization_msgs::Marker::ADD; }));
  const ros::Subscriber targets = node_.subscribe<Target>(
      topics::controller_target, 1, boost::function<void(const Target::ConstPtr&)>([&](const auto& m) {
        target_m = from_message(m->position, "position");
      }));
  ros::Publisher goals = node_.advertise<geometry_msgs::PoseStamped>(topics::controller_goal, 1, true);
  geometry_msgs::PoseStamped goal;
  goal.header.frame_id = room_frame;
  goal.pose.position = to_message(Eigen::Vector3d(0.02, 0.0, -0.095));
  goals.publish(goal);
  const auto is_at_goal = [&] { return target_m && std::abs(target_m->x() - 0.02) < 1e-6; };
  ASSERT_TRUE(spin_until([&] { return ghost && is_at_goal(); }, patience_s));
  spin_until([&] { return false; }, 2.0);  // it is drawn
  bool dragged = false;
  for (int i = 0; i < 5 && !dragged; ++i) {
    rviz_->point(" mousemove 1200 100 click 1 sleep 0.3 key i sleep 0.3");
    rviz_->drag(931, 548, 846, 548, [&] { dragged = spin_until([&] { return target_m->x() < 0.015; }, 8.0); });
  }
  EXPECT_TRUE(dragged) << "the camera turned";
  const Eigen::Vector3d released_m = *target_m;
  EXPECT_TRUE(spin_until([&] { return ghost; }, patience_s));
  const double yaw = 4.15, pitch = 0.3;  // of config/session.rviz
  const Eigen::Vector3d eye(std::cos(yaw) * std::cos(pitch), std::sin(yaw) * std::cos(pitch), std::sin(pitch));
  const Eigen::Vector3d way_m = released_m - Eigen::Vector3d(0.02, 0.0, -0.095);
  EXPECT_NEAR(way_m.dot(eye), 0.0, 1e-3) << "in the plane that faces the eye: " << way_m.transpose();
  EXPECT_EQ(commands_, (std::vector<double>{1.0, 1.0}));
}

// As a panel that comes late hears it: in whatever order.
TEST_F(Panel, KeepsATargetThatItHearsOfBeforeItsRobot) {
  PanelLink link("elsewhere");
  ros::NodeHandle elsewhere("elsewhere");
  Target target;
  target.marker = "tip";
  target.position.x = 0.03;
  const auto hears = [&](const auto& condition) {
    return spin_until(
        [&] {
          link.listen();
          return condition();
        },
        patience_s);
  };
  ros::Publisher targets = elsewhere.advertise<Target>(topics::controller_target, 1, true);
  targets.publish(target);
  ASSERT_TRUE(hears([&] { return link.state().targets() == 1; }));
  ros::Publisher ranges = elsewhere.advertise<ActuatorRanges>(topics::simulator_ranges, 1, true);
  ranges.publish(*hear<ActuatorRanges>(node_, topics::simulator_ranges));
  ASSERT_TRUE(hears([&] { return link.state().values().rows().size() == 2; }));
  ASSERT_TRUE(link.state().target("tip"));
  EXPECT_EQ(link.state().target("tip")->x, 0.03);
}

// A session of another namespace, of which this test is all nodes.
class Elsewhere : public testing::Test {
 protected:
  template <typename Condition>
  bool hears(const Condition& condition, double limit_s = patience_s) {
    const auto listened = [&] {
      link_.listen();
      for (const CallOutcome& outcome : link_.take_outcomes())
        if (!outcome.title.empty()) outcomes_.push_back(outcome);
      return condition();
    };
    return spin_until(listened, limit_s);
  }
  template <typename Message>
  ros::Publisher latched(const std::string& topic) {
    return elsewhere_.advertise<Message>(topic, 1, true);
  }
  static ActuatorRanges ranges_at(double time_s) {
    ActuatorRanges ranges;
    ranges.header.stamp = ros::Time(time_s);
    ranges.names = {"left"};
    ranges.units = {"1"};
    ranges.rests = {1.0};
    ranges.mins = {0.7};
    ranges.maxs = {1.3};
    return ranges;
  }
  static MarkerObservations tip_at(double time_s, double x_m) {
    MarkerObservations markers;
    markers.header.stamp = ros::Time(time_s);
    markers.names = {"tip"};
    markers.positions.resize(1);
    markers.positions[0].x = x_m;
    return markers;
  }
  const CallOutcome* last(const std::string& title) const {
    const CallOutcome* found = nullptr;
    for (const CallOutcome& outcome : outcomes_)
      if (outcome.title == title) found = &outcome;
    return found;
  }

  ros::NodeHandle elsewhere_{"elsewhere"};
  PanelLink link_{"elsewhere"};
  std::vector<CallOutcome> outcomes_;
};

TEST_F(Elsewhere, NothingIsShownOfARobotThatIsGone) {
  ros::Publisher scenes = latched<std_msgs::String>(topics::simulator_scene);
  ros::Publisher ranges = latched<ActuatorRanges>(topics::simulator_ranges);
  ros::Publisher markers = latched<MarkerObservations>(topics::simulator_markers);
  ros::Publisher targets = latched<Target>(topics::controller_target);
  std_msgs::String scene;
  scene.data = "/robots/one.yaml";
  Target target;
  target.marker = "tip";
  target.position.x = 0.5;
  link_.state().plot("tip");
  scenes.publish(scene);
  ranges.publish(ranges_at(10.0));
  ASSERT_TRUE(hears([&] { return link_.state().robots() > 0 && link_.state().scene() == scene.data; }));
  markers.publish(tip_at(11.0, 0.01));
  targets.publish(target);
  ASSERT_TRUE(
      hears([&] { return link_.state().target_marker() == "tip" && !link_.state().history().titles().empty(); }));
  EXPECT_EQ(link_.state().target("tip")->x, 0.5);

  const int before = link_.state().robots();
  scene.data = "/robots/two.yaml";
  scenes.publish(scene);
  ranges.publish(ranges_at(20.0));
  ASSERT_TRUE(hears([&] { return link_.state().robots() >= before + 2; }));
  EXPECT_FALSE(link_.state().target("tip"));
  EXPECT_TRUE(link_.state().markers().names.empty());
  EXPECT_TRUE(link_.state().history().titles().empty());
  markers.publish(tip_at(19.99, 0.01));  // of the first robot, and late
  EXPECT_FALSE(hears([&] { return link_.state().target("tip").has_value(); }, 0.5));
  markers.publish(tip_at(20.01, 0.02));
  ASSERT_TRUE(hears([&] { return link_.state().target("tip").has_value(); }));
  EXPECT_EQ(link_.state().target("tip")->x, 0.02);

  target.marker.clear();  // as the controller says it
  const int heard = link_.state().targets();
  targets.publish(target);
  ASSERT_TRUE(hears([&] { return link_.state().targets() > heard; }));
  EXPECT_EQ(link_.state().target_marker(), "");
}

TEST_F(Elsewhere, SaysWhatCameOfATargetThatIsLetGo) {
  ros::Publisher answers = latched<OptimisePolicyResult>(topics::target_answer);
  OptimisePolicyResult answer;
  answer.success = true;
  answer.message = "converged";
  answer.summary.final_distance_m = 0.00123;
  answer.summary.iterations = 4;
  answers.publish(answer);
  ASSERT_TRUE(hears([&] { return last("Target"); }));
  EXPECT_TRUE(last("Target")->success);
  EXPECT_EQ(last("Target")->message, "1.23 mm from the target after 4 iterations. converged; Execute goes there");
  answer.success = false;
  answer.message = "no rest state";
  answers.publish(answer);
  ASSERT_TRUE(hears([&] { return !last("Target")->success; }));
  EXPECT_EQ(last("Target")->message, "no rest state");
}

// As in a window of view.sh, where a grey button would leave its user guessing.
TEST_F(Elsewhere, SaysWhyNothingCanBeSearchedFor) {
  ASSERT_TRUE(hears([&] { return !link_.why_not(topics::optimise_policy).empty(); }));
  EXPECT_NE(link_.why_not(topics::optimise_policy).find("no controller runs here"), std::string::npos);
  EXPECT_NE(link_.why_not(topics::simulator_load).find("nothing here offers /"), std::string::npos);
  std::atomic<bool> asked{false};
  const ros::ServiceServer search = elsewhere_.advertiseService<OptimisePolicy::Request, OptimisePolicy::Response>(
      topics::optimise_policy, [&](auto&, auto&) { return asked = true; });
  EXPECT_TRUE(hears([&] { return link_.why_not(topics::optimise_policy).empty(); }));
  EXPECT_FALSE(asked);
}

TEST_F(Elsewhere, FollowsAndChangesTheSolver) {
  EXPECT_EQ(link_.state().solver(), "");
  ros::Publisher solver = elsewhere_.advertise<std_msgs::String>(topics::simulator_solver, 1, true);
  std_msgs::String name;
  name.data = "newton";
  solver.publish(name);
  ASSERT_TRUE(hears([&] { return link_.state().solver() == "newton"; }));
  std::string asked;
  const ros::ServiceServer use = elsewhere_.advertiseService<UseSolver::Request, UseSolver::Response>(
      topics::simulator_use_solver, [&](auto& request, auto& response) {
        asked = request.solver;
        response.message = "no such model";
        return true;
      });
  link_.use_solver("reduced");
  ASSERT_TRUE(hears([&] { return last("Solver") != nullptr; }));
  EXPECT_EQ(asked, "reduced");
  EXPECT_FALSE(last("Solver")->success);
  EXPECT_EQ(last("Solver")->message, "no such model");
  EXPECT_EQ(link_.state().solver(), "newton");
}

// What a user stops has not failed, and drives that are to hold are none that move alone.
TEST_F(Elsewhere, OnesOwnStopIsNoFault) {
  std::atomic<bool> stopped{false};
  const auto trigger = [&](const std::string& name) {
    return elsewhere_.advertiseService<std_srvs::Trigger::Request, std_srvs::Trigger::Response>(
        name, [&](auto&, auto& response) { return stopped = true, response.success = true; });
  };
  const ros::ServiceServer stop = trigger(topics::motor_stop), cancel = trigger(topics::cancel_policy);
  const ros::ServiceServer execute = elsewhere_.advertiseService<ExecutePolicy::Request, ExecutePolicy::Response>(
      topics::execute_policy, [&](auto&, auto& response) {
        while (!stopped && ros::ok()) ros::WallDuration(0.01).sleep();
        response.message = "fault: emergency stop; clear it with motor/clear";
        return true;
      });
  ros::AsyncSpinner answering(2);
  ros::Publisher motors = latched<MotorState>(topics::motor_state);
  ros::Publisher ranges = latched<ActuatorRanges>(topics::simulator_ranges);
  ros::Publisher states = latched<ActuatorState>(topics::simulator_actuators);
  MotorState motor;
  motor.linked = true;
  motors.publish(motor);
  ranges.publish(ranges_at(10.0));
  ActuatorState state;
  state.header.stamp = ros::Time(11.0);
  state.names = {"left"};
  state.commands = {0.8};
  state.actuated_commands = {0.9};
  ASSERT_TRUE(hears([&] { return link_.state().robots() > 0 && link_.offers(topics::motor_stop); }));
  states.publish(state);
  ASSERT_TRUE(hears([&] { return link_.state().values().rows()[0].shown == 0.8; }));
  answering.start();
  link_.execute();
  motor.emergency_stop = true;
  motors.publish(motor);
  link_.stop();
  const auto listen_only = [&](const std::string& title) {
    const ros::WallTime limit = ros::WallTime::now() + ros::WallDuration(patience_s);
    while (!last(title) && ros::WallTime::now() < limit) {
      link_.listen();
      for (const CallOutcome& outcome : link_.take_outcomes()) outcomes_.push_back(outcome);
      ros::WallDuration(0.01).sleep();
    }
    return last(title) != nullptr;
  };
  ASSERT_TRUE(listen_only("Execute"));
  ASSERT_TRUE(listen_only("Stop"));
  for (const CallOutcome& outcome : outcomes_) EXPECT_TRUE(outcome.success) << outcome.title << outcome.message;
  EXPECT_EQ(last("Execute")->message, "ended by Stop");
  EXPECT_EQ(last("Move"), nullptr);
  link_.state().values().edit("left", 1.1, machine_time_s());  // now by hand
  ASSERT_TRUE(listen_only("Move"));
  EXPECT_FALSE(last("Move")->success);
  EXPECT_EQ(last("Move")->message, "the simulation alone moves: the motors hold until Clear");
}

TEST_F(Panel, ShowsTheTargetThatIsChosen) {
  const auto shown_x_m = [&] {
    return hear<visualization_msgs::InteractiveMarkerInit>(node_, std::string(topics::target_marker) + "/update_full");
  };
  const auto ball_m = [&] { return shown_x_m()->markers.at(0).pose.position.x; };
  const double before_m = ball_m();
  ros::Publisher shown = node_.advertise<Target>(topics::target_shown, 1, true);
  Target target;
  target.marker = "tip";
  target.position = to_message(Eigen::Vector3d(before_m + 0.011, 0.0, -0.09));
  shown.publish(target);
  EXPECT_TRUE(spin_until([&] { return std::abs(ball_m() - before_m - 0.011) < 1e-9; }, patience_s));
  target.marker = "nose";
  target.position.x += 1.0;
  shown.publish(target);
  EXPECT_FALSE(spin_until([&] { return std::abs(ball_m() - target.position.x) < 1e-9; }, 1.0)) << "there is no nose";
}

TEST_F(Panel, ShowsTheTargetOfASearchThatFindsNothing) {
  const OptimisePolicy::Request endless = endless_search({0.0123, 0.0, -0.095});
  auto answer =
      std::async(std::launch::async, [&] { return ask<OptimisePolicy>(node_, topics::optimise_policy, endless); });
  const auto ball_m = [&] {
    return hear<visualization_msgs::InteractiveMarkerInit>(node_, std::string(topics::target_marker) + "/update_full")
        ->markers.at(0)
        .pose.position.x;
  };
  EXPECT_TRUE(spin_until([&] { return std::abs(ball_m() - endless.target.x) < 1e-9; }, patience_s));
  ask<std_srvs::Trigger>(node_, topics::cancel_policy);
  EXPECT_FALSE(answer.get().message.empty());
  EXPECT_EQ(ball_m(), endless.target.x);
}

TEST_F(Panel, OptimisesForTheTargetThatItShows) {
  const ros::Time pressed = ros::Time::now();
  std::string method;
  const ros::Subscriber progress = node_.subscribe<PolicyProgress>(
      topics::controller_progress, 100,
      boost::function<void(const PolicyProgress::ConstPtr&)>([&](const auto& m) { method = m->method; }));
  bool ghost = false;
  const ros::Subscriber ghosts = node_.subscribe<visualization_msgs::Marker>(
      topics::controller_ghost, 10,
      boost::function<void(const visualization_msgs::Marker::ConstPtr&)>(
          [&](const auto& m) { ghost = m->action == visualization_msgs::Marker::ADD && m->header.stamp > pressed; }));
  EXPECT_TRUE(press_until("alt+o", [&] { return !method.empty() && ghost; }));
  EXPECT_EQ(method, "gauss_newton");
  EXPECT_EQ(commands_, (std::vector<double>{1.0, 1.0})) << "it only shows";
}

TEST_F(Panel, FindsReachableTipsAndTheGhostOfOneThatIsChosen) {
  std::vector<geometry_msgs::Point> tips;
  const ros::Subscriber clouds = node_.subscribe<visualization_msgs::Marker>(
      topics::panel_tips, 1,
      boost::function<void(const visualization_msgs::Marker::ConstPtr&)>([&](const auto& m) { tips = m->points; }));
  std::optional<Eigen::Vector3d> target_m;
  const ros::Subscriber targets = node_.subscribe<Target>(
      topics::controller_target, 1, boost::function<void(const Target::ConstPtr&)>([&](const auto& m) {
        target_m = from_message(m->position, "position");
      }));
  rviz_->press("alt+w");
  ASSERT_TRUE(press_until(
      "alt+i", [&] { return !tips.empty(); }, 120.0))
      << "pressed again it would stop";
  EXPECT_TRUE(spin_until([&] { return tips.size() > 20u; }, 120.0)) << tips.size() << " came one by one";
  const auto is_a_tip = [&](const Eigen::Vector3d& place_m) {
    return std::any_of(tips.begin(), tips.end(),
                       [&](const auto& tip) { return (from_message(tip, "tips") - place_m).norm() < 1e-6; });
  };
  EXPECT_TRUE(press_until(
      "alt+n Up", [&] { return target_m && is_a_tip(*target_m); }, 10.0));
  rviz_->press("alt+l");
}

// With `right` slack the bar bends away from it.
TEST_F(Panel, PullsAtTheSkinUnderTheMouse) {
  ASSERT_TRUE(press_until("alt+2 End", [&] { return commands_[1] > 1.4; }));
  bool pulled = false;
  for (int i = 0; i < 5 && !pulled; ++i) {
    rviz_->point(" mousemove 1200 100 click 1 sleep 0.3 key h sleep 0.3");
    rviz_->drag(874, 540, 724, 540, [&] { pulled = spin_until([&] { return (tip_ - rest_tip_).x() < -0.004; }, 8.0); });
  }
  EXPECT_TRUE(pulled);
  EXPECT_TRUE(spin_until([&] { return (tip_ - rest_tip_).norm() < 1e-3; }, patience_s)) << "it is let go";
  rviz_->point(" mousemove 1200 100 click 1 sleep 0.3 key i");
}

TEST_F(Panel, RecordsUntilRecordIsPressedAgain) {
  namespace fs = std::filesystem;
  const fs::path folder = ros::NodeHandle("session_watch").param<std::string>("bag_folder", "");
  bool recording = false;
  const ros::Subscriber heard = node_.subscribe<std_msgs::Bool>(
      topics::session_recording, 1,
      boost::function<void(const std_msgs::Bool::ConstPtr&)>([&](const auto& m) { recording = m->data != 0; }));
  const auto bags = [&](const std::string& ending) {
    std::error_code none;
    int count = 0;
    for (const auto& file : fs::directory_iterator(folder, none)) count += file.path().extension() == ending ? 1 : 0;
    return count;
  };
  const int before = bags(".bag");
  ASSERT_TRUE(press_until("alt+d", [&] { return recording; }));
  ASSERT_TRUE(spin_until([&] { return bags(".active") == 1; }, patience_s));
  ASSERT_TRUE(press_until("alt+d", [&] { return !recording; }));
  EXPECT_TRUE(spin_until([&] { return bags(".bag") == before + 1 && bags(".active") == 0; }, patience_s));
}

// Each is asked for before the recorder of the one before has begun, or as it closes its bag.
TEST_F(Panel, RecordsNothingBrokenWhereItIsSwitchedOnAndOffAtOnce) {
  namespace fs = std::filesystem;
  const fs::path folder = ros::NodeHandle("session_watch").param<std::string>("bag_folder", "");
  fs::create_directories(folder);
  std::set<fs::path> before;
  for (const auto& file : fs::directory_iterator(folder)) before.insert(file.path());
  std_srvs::SetBool::Request on, off;
  on.data = 1;
  for (const double seconds : {0.0, 0.3, 0.6, 1.0}) {
    const auto started = ask<std_srvs::SetBool>(node_, topics::session_record, on);
    EXPECT_TRUE(started.success) << started.message;
    ros::WallDuration(seconds).sleep();
    const auto stopped = ask<std_srvs::SetBool>(node_, topics::session_record, off);
    EXPECT_TRUE(stopped.success) << stopped.message;
  }
  EXPECT_FALSE(ask<std_srvs::SetBool>(node_, topics::session_record, off).success) << "nothing is recorded any more";
  for (const auto& file : fs::directory_iterator(folder)) {
    if (before.count(file.path()) > 0) continue;
    EXPECT_EQ(file.path().extension(), ".bag");
    EXPECT_NO_THROW(open_bag(file.path())) << file.path();
  }
}

// As `nice` has it, of any of its threads, the most.
int largest_nice_of(pid_t process) {
  int largest = -20;
  for (const auto& thread : std::filesystem::directory_iterator("/proc/" + std::to_string(process) + "/task"))
    largest = std::max(largest, getpriority(PRIO_PROCESS, static_cast<id_t>(std::stoi(thread.path().filename()))));
  return largest;
}

// How long its window let others wait meanwhile is printed: that hangs on the machine, and on who draws.
TEST_F(Panel, MovesTheRobotWhileItSearches) {
  std::vector<double> gaps_s, works_s;
  const ros::Subscriber diagnoses = node_.subscribe<diagnostic_msgs::DiagnosticArray>(
      "/diagnostics", 100, boost::function<void(const diagnostic_msgs::DiagnosticArray::ConstPtr&)>([&](const auto& m) {
        if (m->status[0].name != "panel_rviz: window") return;
        gaps_s.push_back(std::stod(m->status[0].values[0].value));
        works_s.push_back(std::stod(m->status[0].values[1].value));
      }));
  const OptimisePolicy::Request endless = endless_search({0.02, 0.0, -0.095});
  auto answer =
      std::async(std::launch::async, [&] { return ask<OptimisePolicy>(node_, topics::optimise_policy, endless); });
  EXPECT_TRUE(press_until("alt+1 Next", [&] { return commands_[0] < 0.95; }));
  EXPECT_EQ(answer.wait_for(std::chrono::seconds(0)), std::future_status::timeout) << "it still searches";
  EXPECT_GE(largest_nice_of(process_of("/controller")), 10) << "the search comes after the window";
  EXPECT_TRUE(spin_until([&] { return !gaps_s.empty(); }, patience_s)) << "its window answers";
  std::printf(
      "longest gap of the window in each second of the search: %.3f s in the median, %.3f s at most; of it work: "
      "%.3f s, %.3f s\n",
      median(gaps_s), quantile(gaps_s, 1.0), median(works_s), quantile(works_s, 1.0));
  ask<std_srvs::Trigger>(node_, topics::cancel_policy);
  EXPECT_FALSE(answer.get().message.empty());
}

TEST_F(Panel, StopsAPolicyWhereItIs) {
  ExecutePolicy::Request slow;
  slow.policy.names = {"left"};
  slow.policy.steps.resize(1);
  slow.policy.steps[0].time_s = 3000.0;
  slow.policy.steps[0].values = {0.8};
  auto answer = std::async(std::launch::async, [&] { return ask<ExecutePolicy>(node_, topics::execute_policy, slow); });
  ASSERT_TRUE(spin_until([&] { return commands_[0] < 1.0; }, patience_s));
  const auto ended = [&] { return answer.wait_for(std::chrono::seconds(0)) == std::future_status::ready; };
  if (!press_until("alt+s", ended)) ask<std_srvs::Trigger>(node_, topics::cancel_policy);
  EXPECT_EQ(answer.get().message, "cancelled");
  hear_more_states(50);
  const std::vector<double> held = commands_;
  hear_more_states(100);
  EXPECT_EQ(commands_, held);
  EXPECT_TRUE(rviz_->runs());
}

// The last: while the hand still holds the skin.
TEST_F(Panel, EndsWithoutACrash) {
  if (const char* picture = std::getenv("PANEL_TEST_PICTURE")) rviz_->take_picture(picture);
  ASSERT_TRUE(press_until("alt+2 End", [&] { return commands_[1] > 1.4; }));
  bool pulled = false;
  int status = -1;
  for (int i = 0; i < 5 && !pulled; ++i) {
    rviz_->point(" mousemove 1200 100 click 1 sleep 0.3 key h sleep 0.3");
    rviz_->drag(874, 540, 724, 540, [&] {
      pulled = spin_until([&] { return (tip_ - rest_tip_).x() < -0.004; }, 8.0);
      if (pulled) status = rviz_->end();
    });
  }
  EXPECT_TRUE(pulled);
  EXPECT_EQ(status, 0);
}

}  // namespace
}  // namespace soft_robot_lab
