// SPDX-License-Identifier: BSD-3-Clause
// A whole simulated session of a coarse bar: topics flow, services answer, bad requests change nothing.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <future>
#include <limits>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <geometry_msgs/WrenchStamped.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Clock.h>
#include <sensor_msgs/JointState.h>
#include <soft_robot_lab/ExecutePolicy.h>
#include <soft_robot_lab/LoadScene.h>
#include <soft_robot_lab/OptimisePolicy.h>
#include <soft_robot_lab/SkinPull.h>
#include <std_msgs/String.h>
#include <std_srvs/Trigger.h>
#include <tf2_msgs/TFMessage.h>
#include <visualization_msgs/MarkerArray.h>

#include "session_ears.h"
#include "ros/base/latched_publisher.h"
#include "ros/messages/conversions.h"
#include "ros/base/topics.h"

namespace soft_robot_lab {
namespace {

const std::string scenes = SOFT_ROBOT_LAB_SOURCE "/test/data/scenes/";
const double cable_compliance_m_n = 1.0e-5;  // of cable_bar.yaml

class Session : public testing::Test {
 protected:
  template <typename Message>
  typename Message::ConstPtr hear(const std::string& topic) {
    return soft_robot_lab::hear<Message>(node_, topic);
  }

  template <typename Service>
  typename Service::Response ask(const std::string& name, const typename Service::Request& request = {}) {
    return soft_robot_lab::ask<Service>(node_, name, request);
  }

  void expect_goes_on() {
    const ros::Time before = hear<MarkerObservations>(topics::simulator_markers)->header.stamp;
    EXPECT_GT(hear<MarkerObservations>(topics::simulator_markers)->header.stamp, before);
  }

  // As the simulator's next diagnostics have it. One subscriber for all of them: all nodes publish in phase, so whoever
  // subscribes anew after each message may hear the same other node for ever.
  int refused_commands() {
    std::optional<int> refused;
    const ros::Subscriber diagnostics = node_.subscribe<diagnostic_msgs::DiagnosticArray>(
        "/diagnostics", 100,
        boost::function<void(const diagnostic_msgs::DiagnosticArray::ConstPtr&)>([&](const auto& m) {
          for (const auto& status : m->status) {
            for (const auto& value : status.values) {
              if (value.key == "refused commands") refused = std::stoi(value.value);
            }
          }
        }));
    if (!spin_until([&] { return refused.has_value(); })) throw std::runtime_error("no diagnostics of the simulator");
    return *refused;
  }

  void expect_counted(const ActuatorCommand& command) {
    const int before = refused_commands();
    // Latched, as the controller listens too and may be connected before the simulator.
    ros::Publisher publisher = node_.advertise<ActuatorCommand>(topics::actuator_command, 1, true);
    publisher.publish(command);
    int now = before;
    for (int i = 0; i < 5 && now == before; ++i) now = refused_commands();
    EXPECT_EQ(now, before + 1);
    expect_goes_on();
  }

  ros::NodeHandle node_;
};

OptimisePolicy::Request good_request() {
  OptimisePolicy::Request request;
  request.method = "gauss_newton";
  request.marker = "tip";
  request.target = to_message(Eigen::Vector3d(0.03, 0.0, -0.09));
  return request;
}

TEST_F(Session, TellsItsClockSceneAndFrames) {
  EXPECT_GT(hear<rosgraph_msgs::Clock>("/clock")->clock, ros::Time(0.0));
  EXPECT_EQ(hear<std_msgs::String>(topics::simulator_scene)->data, scenes + "cable_bar.yaml");
  const auto frames = hear<tf2_msgs::TFMessage>("/tf_static");
  ASSERT_EQ(frames->transforms.size(), 1u);
  EXPECT_EQ(frames->transforms[0].header.frame_id, "world");
  EXPECT_EQ(frames->transforms[0].child_frame_id, "robot_base");
}

TEST_F(Session, PublishesMarkersThatHangAtRest) {
  const auto markers = hear<MarkerObservations>(topics::simulator_markers);
  EXPECT_EQ(markers->header.frame_id, "robot_base");
  ASSERT_EQ(markers->names, (std::vector<std::string>{"tip", "middle"}));
  ASSERT_EQ(markers->positions.size(), 2u);
  EXPECT_EQ(markers->covariances.size(), 18u);
  EXPECT_EQ(markers->sources[0], MarkerObservations::SIMULATED);
  const Eigen::Vector3d tip_m = position_of(*markers, "tip");
  EXPECT_LT(tip_m.z(), -0.10001);  // its weight stretches it, little, as both cables are taut at rest
  EXPECT_GT(tip_m.z(), -0.101);
}

// Bending between its cables, by 4.7 mm after Euler and Bernoulli.
TEST_F(Session, IsPulledAtItsSkinUntilTheHandLetsGo) {
  const Eigen::Vector3d rest_m = position_of(*hear<MarkerObservations>(topics::simulator_markers), "tip");
  ros::Publisher publisher = node_.advertise<SkinPull>(topics::simulator_pull, 1);
  ASSERT_TRUE(spin_until([&] { return publisher.getNumSubscribers() > 0; }));
  SkinPull pull;
  pull.header.frame_id = "world";
  pull.point = to_message(rest_m);
  double off_m = 0.0;
  const ros::Subscriber markers = node_.subscribe<MarkerObservations>(
      topics::simulator_markers, 1, boost::function<void(const MarkerObservations::ConstPtr&)>([&](const auto& m) {
        off_m = position_of(*m, "tip").y() - rest_m.y();
        if (pull.force.y != 0.0) publisher.publish(pull);
      }));
  for (const bool silent : {false, true}) {
    pull.force.y = 0.05;
    EXPECT_TRUE(spin_until([&] { return off_m > 0.003; })) << off_m;
    spin_until([&] { return false; }, 0.5);
    EXPECT_LT(off_m, 0.007);
    pull.force.y = 0.0;
    if (!silent) publisher.publish(pull);
    EXPECT_TRUE(spin_until([&] { return off_m < 0.0003; })) << off_m << (silent ? ": nobody repeats it" : ": let go");
  }
  pull.force.y = 0.05;
  pull.point.y += 1.0;
  spin_until([&] { return false; }, 0.5);
  EXPECT_LT(std::abs(off_m), 0.0003) << "nothing is there to be held";
  EXPECT_TRUE(ask<std_srvs::Trigger>(topics::simulator_reset).success) << "others find it at rest";
}

TEST_F(Session, PublishesCablesSurfaceAndOverlay) {
  const auto actuators = hear<ActuatorState>(topics::simulator_actuators);
  EXPECT_EQ(actuators->names, (std::vector<std::string>{"left", "right"}));
  ASSERT_EQ(actuators->cables.size(), 2u);
  EXPECT_NEAR(actuators->cables[0].rest_length_m, 0.1, 1e-6);
  EXPECT_GE(actuators->cables[0].tension_n, 0.0);
  EXPECT_NEAR(actuators->cables[0].stretch_m, cable_compliance_m_n * actuators->cables[0].tension_n, 1e-9);
  EXPECT_GE(actuators->cables[0].slack_m, 0.0);
  EXPECT_EQ(actuators->cables[0].pretension_n, 0.0);
  EXPECT_GE(actuators->cables[0].path.size(), 2u);
  const auto surface = hear<visualization_msgs::Marker>(topics::simulator_surface);
  EXPECT_GT(surface->points.size(), 0u);
  EXPECT_EQ(surface->points.size() % 3, 0u);
  EXPECT_FALSE(hear<visualization_msgs::MarkerArray>(topics::overlay)->markers.empty());
}

TEST_F(Session, PublishesWhatOtherToolsKnow) {
  const auto joints = hear<sensor_msgs::JointState>(topics::simulator_joint_states);
  const auto actuators = hear<ActuatorState>(topics::simulator_actuators);
  EXPECT_EQ(joints->name, actuators->names);
  ASSERT_EQ(joints->position.size(), 2u);
  ASSERT_EQ(joints->effort.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(joints->position[i], actuators->actuated_commands[i], 1e-9);
    EXPECT_NEAR(joints->effort[i], actuators->cables[i].tension_n, 1e-6);
  }
  const auto reaction = hear<geometry_msgs::WrenchStamped>(topics::simulator_reaction);
  EXPECT_EQ(reaction->header.frame_id, "robot_base");
  const double weight_n = 0.02 * 0.02 * 0.1 * 1070.0 * 9.81;
  EXPECT_NEAR(reaction->wrench.force.z, weight_n, 1e-3 * weight_n);
  std::set<std::string> frames;
  const auto in_time = [&](const auto& m) {
    for (const auto& one : m->transforms) frames.insert(one.header.frame_id + " -> " + one.child_frame_id);
  };
  const ros::Subscriber tree = node_.subscribe<tf2_msgs::TFMessage>(
      "/tf", 10, boost::function<void(const tf2_msgs::TFMessage::ConstPtr&)>(in_time));
  EXPECT_TRUE(spin_until([&] { return frames.count("robot_base -> simulated/tip") > 0; }));
}

TEST_F(Session, ResetsToTheStart) {
  const auto response = ask<std_srvs::Trigger>(topics::simulator_reset);
  EXPECT_TRUE(response.success) << response.message;
  expect_goes_on();
}

TEST_F(Session, RefusesABadSceneAndGoesOnWithTheOld) {
  // The last ones name files in the folder of a node, or none.
  for (const std::string& path :
       {scenes + "no_such_file.yaml", scenes + "unknown_key.yaml", std::string(),
        std::filesystem::relative(scenes + "cable_bar.yaml").string(), std::string("\0x", 2)}) {
    LoadScene::Request request;
    request.path = path;
    const auto response = ask<LoadScene>(topics::simulator_load, request);
    EXPECT_FALSE(response.success) << path;
    EXPECT_FALSE(response.message.empty()) << path;
    EXPECT_EQ(hear<std_msgs::String>(topics::simulator_scene)->data, scenes + "cable_bar.yaml");
    expect_goes_on();
  }
}

TEST_F(Session, NamesKeyAndLineOfABadScene) {
  LoadScene::Request request;
  request.path = scenes + "unknown_key.yaml";
  const auto response = ask<LoadScene>(topics::simulator_load, request);
  EXPECT_NE(response.message.find("unknown_key.yaml:5"), std::string::npos) << response.message;
  EXPECT_NE(response.message.find("colour"), std::string::npos) << response.message;
}

TEST_F(Session, LoadsASceneAgain) {
  LoadScene::Request request;
  request.path = scenes + "cable_bar.yaml";
  const auto response = ask<LoadScene>(topics::simulator_load, request);
  EXPECT_TRUE(response.success) << response.message;
  expect_goes_on();
}

// It would run, but from nowhere near where it hangs.
TEST_F(Session, RefusesASceneThatDoesNotComeToRest) {
  LoadScene::Request request;
  request.path = scenes + "restless_bar.yaml";
  const auto response = ask<LoadScene>(topics::simulator_load, request);
  EXPECT_FALSE(response.success);
  EXPECT_NE(response.message.find("restless_bar.yaml: does not start at rest: "), std::string::npos)
      << response.message;
  EXPECT_EQ(hear<std_msgs::String>(topics::simulator_scene)->data, scenes + "cable_bar.yaml");
  expect_goes_on();
}

// A step of a ballooning chamber is solved for minutes. Stop and Reset are answered meanwhile, each of several times:
// the diagnosis, which waits for the solve too, shall not keep them.
TEST_F(Session, EndsWhatIsSolvedForLongByStopAndByReset) {
  LoadScene::Request request;
  request.path = scenes + "ballooning_arm.yaml";
  const auto loaded = ask<LoadScene>(topics::simulator_load, request);
  ASSERT_TRUE(loaded.success) << loaded.message;
  ros::Publisher publisher = node_.advertise<ActuatorCommand>(topics::actuator_command, 1, true);  // latched, as above
  ActuatorCommand command;
  command.names = {"a"};
  command.values = {40000.0};
  ros::SteadyTime heard = ros::SteadyTime::now();
  const ros::Subscriber states = node_.subscribe<ActuatorState>(
      topics::simulator_actuators, 1,
      boost::function<void(const ActuatorState::ConstPtr&)>([&](const auto&) { heard = ros::SteadyTime::now(); }));
  const auto silence_s = [&] { return (ros::SteadyTime::now() - heard).toSec(); };
  ASSERT_TRUE(spin_until([&] { return publisher.getNumSubscribers() > 0 && silence_s() < 0.5; }, 60.0));
  std::string said;  // silence alone may be a busy machine's, before the command is heard
  const ros::Subscriber diagnostics = node_.subscribe<diagnostic_msgs::DiagnosticArray>(
      "/diagnostics", 100, boost::function<void(const diagnostic_msgs::DiagnosticArray::ConstPtr&)>([&](const auto& m) {
        for (const auto& status : m->status)
          if (status.name == "simulator: simulation") said = status.message;
      }));
  const auto lasts = [&] { return said.rfind("solving for ", 0) == 0 && said.rfind("solving for 0", 0) != 0; };
  std::vector<double> answers_s;
  for (int i = 0; i < 6; ++i) {
    said.clear();
    publisher.publish(command);
    ASSERT_TRUE(spin_until(lasts, 60.0)) << "no step lasts";
    spin_until([] { return false; }, 0.15 * i);
    const ros::SteadyTime asked = ros::SteadyTime::now();
    EXPECT_TRUE(ask<std_srvs::Trigger>(i % 2 == 0 ? topics::simulator_stop : topics::simulator_reset).success);
    answers_s.push_back((ros::SteadyTime::now() - asked).toSec());
    ASSERT_TRUE(spin_until([&] { return silence_s() < 0.5; }, 60.0)) << "it does not go on";
    ask<std_srvs::Trigger>(topics::simulator_reset);
  }
  said.clear();
  publisher.publish(command);
  ASSERT_TRUE(spin_until(lasts, 60.0)) << "no step lasts";
  RecordProperty("longest_answer_s", std::to_string(*std::max_element(answers_s.begin(), answers_s.end())));
  request.path = scenes + "cable_bar.yaml";
  EXPECT_TRUE(ask<LoadScene>(topics::simulator_load, request).success);
}

TEST_F(Session, PublishesTinyStepsAtMostAThousandTimesASecond) {
  LoadScene::Request request;
  request.path = scenes + "cable_bar_tiny_step.yaml";
  const auto tiny = ask<LoadScene>(topics::simulator_load, request);
  ASSERT_TRUE(tiny.success) << tiny.message;
  int heard = 0;
  const ros::Subscriber all = node_.subscribe<MarkerObservations>(
      topics::simulator_markers, 100000,
      boost::function<void(const MarkerObservations::ConstPtr&)>([&](const auto&) { ++heard; }));
  const ros::SteadyTime begin = ros::SteadyTime::now();
  EXPECT_TRUE(spin_until([&] { return heard >= 1000; }, 60.0));
  EXPECT_LT(heard, 1500.0 * (ros::SteadyTime::now() - begin).toSec());  // a busy machine only publishes less often
  request.path = scenes + "cable_bar.yaml";
  EXPECT_TRUE(ask<LoadScene>(topics::simulator_load, request).success);
}

TEST_F(Session, RefusesBadOptimisations) {
  struct Case {
    const char* words;  // expected in the message
    void (*spoil)(OptimisePolicy::Request&);
  };
  const Case cases[] = {
      {"tail", [](auto& r) { r.marker = "tail"; }},
      {"tip", [](auto& r) { r.marker = ""; }},
      {"nan", [](auto& r) { r.target.y = NAN; }},
      {"inf", [](auto& r) { r.target.z = std::numeric_limits<double>::infinity(); }},
      {"gauss_newton", [](auto& r) { r.method = ""; }},
      {"guess", [](auto& r) { r.method = "guess"; }},
      {"tail",
       [](auto& r) {
         r.limits.resize(1);
         r.limits[0].name = "tail";
       }},
      {"limits: [-1, 1] for 'left'",
       [](auto& r) {
         r.limits.resize(1);
         r.limits[0].name = "left";
         r.limits[0].min = -1.0;
         r.limits[0].max = 1.0;
       }},
  };
  for (const Case& wrong : cases) {
    OptimisePolicy::Request request = good_request();
    wrong.spoil(request);
    const auto response = ask<OptimisePolicy>(topics::optimise_policy, request);
    EXPECT_FALSE(response.success) << wrong.words;
    EXPECT_NE(response.message.find(wrong.words), std::string::npos) << response.message;
    EXPECT_TRUE(response.policy.names.empty());
  }
  expect_goes_on();
}

TEST_F(Session, BringsTheTipCloserAsTheModelExpects) {
  int iterations = 0;
  const ros::Subscriber progress = node_.subscribe<PolicyProgress>(
      topics::controller_progress, 1000, boost::function<void(const PolicyProgress::ConstPtr&)>([&](const auto& m) {
        EXPECT_TRUE(std::isfinite(m->distance_m));
        ++iterations;
      }));
  while (progress.getNumPublishers() == 0) ros::WallDuration(0.01).sleep();

  const OptimisePolicy::Request request = good_request();
  const auto optimised = ask<OptimisePolicy>(topics::optimise_policy, request);
  ASSERT_TRUE(optimised.success) << optimised.message;
  EXPECT_LT(optimised.summary.final_distance_m, 0.5 * optimised.summary.initial_distance_m);

  ExecutePolicy::Request play;
  play.policy = optimised.policy;
  play.wait_until_rest = true;
  EXPECT_EQ(play.policy.robot, "cable_bar");
  play.policy.robot = "gripper";
  const auto refused = ask<ExecutePolicy>(topics::execute_policy, play);
  EXPECT_FALSE(refused.success);
  EXPECT_EQ(
      refused.message,
      "policy.robot: this policy is for 'gripper', and 'cable_bar' runs; leave `robot` out to play it all the same");
  play.policy.robot = optimised.policy.robot;
  const auto executed = ask<ExecutePolicy>(topics::execute_policy, play);
  ASSERT_TRUE(executed.success) << executed.message;
  EXPECT_GE(executed.duration_s, optimised.policy.steps.back().time_s);
  const Eigen::Vector3d target_m = from_message(request.target, "target");
  EXPECT_NEAR((position_of(executed.markers, "tip") - target_m).norm(), optimised.summary.final_distance_m, 2e-4);
  ros::spinOnce();
  EXPECT_GT(iterations, 0);
  const auto state = hear<ActuatorState>(topics::simulator_actuators);
  EXPECT_EQ(state->commands, optimised.policy.steps.back().values);
}

TEST_F(Session, RefusesASecondOptimisationWhileOneRuns) {
  bool started = false;
  const ros::Subscriber progress = node_.subscribe<PolicyProgress>(
      topics::controller_progress, 1,
      boost::function<void(const PolicyProgress::ConstPtr&)>([&](const auto&) { started = true; }));
  while (progress.getNumPublishers() == 0) ros::WallDuration(0.01).sleep();
  OptimisePolicy::Request slow = good_request();
  slow.method = "rmsprop";
  auto first = std::async(std::launch::async, [&] { return ask<OptimisePolicy>(topics::optimise_policy, slow); });
  while (!started) ros::spinOnce();
  const auto second = ask<OptimisePolicy>(topics::optimise_policy, good_request());
  EXPECT_FALSE(second.success);
  EXPECT_NE(second.message.find("busy"), std::string::npos) << second.message;
  EXPECT_TRUE(ask<std_srvs::Trigger>(topics::cancel_policy).success);
  const auto cancelled = first.get();
  EXPECT_TRUE(cancelled.success);
  EXPECT_EQ(cancelled.message, "cancelled");
  EXPECT_EQ(cancelled.policy.steps.size(), 1u);
  EXPECT_FALSE(ask<std_srvs::Trigger>(topics::cancel_policy).success);
}

TEST_F(Session, FindsAPathOfPoses) {
  OptimisePolicy::Request request = good_request();
  request.marker.clear();
  request.poses.resize(2);
  for (size_t i = 0; i < 2; ++i) {
    request.poses[i].markers = {"tip"};
    request.poses[i].targets = {to_message(Eigen::Vector3d(i == 0 ? 0.02 : -0.02, 0.0, -0.095))};
  }
  const auto response = ask<OptimisePolicy>(topics::optimise_policy, request);
  EXPECT_TRUE(response.success) << response.message;
  ASSERT_EQ(response.policy.steps.size(), 2u);
  ASSERT_EQ(response.poses.size(), 2u);
  EXPECT_GT(response.poses[0].marker.x, 0.01);
  EXPECT_LT(response.poses[1].marker.x, -0.01);
}

// Until drives and silicone are there; then it goes. Its skin is the one that the robot comes to.
TEST_F(Session, ShowsAtOnceWhereCommandsLead) {
  ask<std_srvs::Trigger>(topics::simulator_reset);
  visualization_msgs::Marker shown, skin;
  const auto keep = [&](const std::string& topic, visualization_msgs::Marker& last) {
    return node_.subscribe<visualization_msgs::Marker>(
        topic, 100,
        boost::function<void(const visualization_msgs::Marker::ConstPtr&)>([&last](const auto& m) { last = *m; }));
  };
  const ros::Subscriber skins = keep(topics::simulator_surface, skin),
                        previews = keep(topics::controller_preview, shown);
  ros::Publisher publisher = node_.advertise<ActuatorCommand>(topics::actuator_command, 1, true);
  ASSERT_TRUE(spin_until([&] { return shown.action == visualization_msgs::Marker::DELETE && !skin.points.empty(); }));
  const visualization_msgs::Marker at_rest = skin;  // on a busy machine it is far on its way when the preview is heard
  ActuatorCommand command;
  command.names = {"left"};
  command.values = {0.85};
  publisher.publish(command);
  ASSERT_TRUE(spin_until([&] { return shown.action == visualization_msgs::Marker::ADD; }));
  const visualization_msgs::Marker preview = shown;
  const auto apart_m = [&](const visualization_msgs::Marker& from) {
    double most_m = 0.0;
    for (size_t i = 0; i < preview.points.size(); ++i) {
      const Eigen::Vector3d there_m = from_message(preview.points[i], "preview");
      most_m = std::max(most_m, (there_m - from_message(from.points.at(i), "surface")).norm());
    }
    return most_m;
  };
  EXPECT_GT(apart_m(at_rest), 0.01);
  EXPECT_TRUE(spin_until([&] { return shown.action == visualization_msgs::Marker::DELETE; }));
  EXPECT_TRUE(spin_until([&] { return apart_m(skin) < 1e-4; })) << apart_m(skin);
}

// The ghost of what was found while another policy played.
TEST_F(Session, KeepsTheGhostWhereAnotherPolicyEnds) {
  ExecutePolicy::Request playing;
  playing.policy.names = {"left"};
  playing.policy.steps.resize(1);
  playing.policy.steps[0].time_s = 3.0;
  playing.policy.steps[0].values = {0.95};
  auto played =
      std::async(std::launch::async, [&] { return ask<ExecutePolicy>(topics::execute_policy, playing).success; });
  ASSERT_TRUE(spin_until([&] { return hear<ActuatorState>(topics::simulator_actuators)->commands[0] < 1.0; }));
  OptimisePolicy::Request search = good_request();
  search.target = to_message(Eigen::Vector3d(0.02, 0.0, -0.095));
  search.tolerance_m = 2e-3;
  ASSERT_TRUE(ask<OptimisePolicy>(topics::optimise_policy, search).success);
  ASSERT_NE(played.wait_for(std::chrono::seconds(0)), std::future_status::ready);
  ASSERT_TRUE(played.get());
  EXPECT_EQ(hear<visualization_msgs::Marker>(topics::controller_ghost)->action, visualization_msgs::Marker::ADD);
}

TEST_F(Session, RefusesBadPolicies) {
  ExecutePolicy::Request request;
  request.policy.names = {"tail"};
  request.policy.steps.resize(1);
  request.policy.steps[0].values = {0.9};
  EXPECT_NE(ask<ExecutePolicy>(topics::execute_policy, request).message.find("'tail'"), std::string::npos);
  request.policy.names = {"left"};
  request.policy.steps[0].values = {-3.0};
  EXPECT_FALSE(ask<ExecutePolicy>(topics::execute_policy, request).success);
  request.policy.steps[0].values = {0.9};
  request.policy.steps[0].time_s = 2.0;
  request.time_limit_s = 1.0;
  EXPECT_NE(ask<ExecutePolicy>(topics::execute_policy, request).message.find("time_limit_s: 1"), std::string::npos);
  request.time_limit_s = std::numeric_limits<double>::infinity();
  EXPECT_NE(ask<ExecutePolicy>(topics::execute_policy, request).message.find("time_limit_s: inf"), std::string::npos);
}

// Subscribers that come before and after a message, and while it is published.
TEST_F(Session, AnnouncementsAreHeardOnceByEveryone) {
  LatchedPublisher<std_msgs::String> latched_publisher("announced");
  std::vector<std::vector<std::string>> heard(20);
  std::vector<ros::Subscriber> subscribers;
  const auto listen = [&] {
    subscribers.push_back(node_.subscribe<std_msgs::String>(
        "announced", 1, [words = &heard[subscribers.size()]](const std_msgs::String::ConstPtr& message) {
          words->push_back(message->data);
        }));
  };
  const auto all_heard = [&](size_t messages) {
    return std::all_of(heard.begin(), heard.end(), [&](const auto& words) { return words.size() == messages; });
  };
  std_msgs::String message;
  message.data = "first";
  for (int i = 0; i < 10; ++i) listen();
  latched_publisher.publish(message);
  for (int i = 0; i < 10; ++i) listen();
  EXPECT_TRUE(spin_until([&] { return all_heard(1); }));
  message.data = "second";
  latched_publisher.publish(message);
  EXPECT_TRUE(spin_until([&] { return all_heard(2); }));
  for (const auto& words : heard) EXPECT_EQ(words, (std::vector<std::string>{"first", "second"}));
}

// None is lost to a new connection, and who comes late hears the last.
TEST_F(Session, PicturesThatChangeOftenAreAllHeard) {
  PresentPublisher<std_msgs::String> pictures("pictures");
  std::vector<std::string> sent, heard;
  const auto listen = [&](std::vector<std::string>& words) {
    return node_.subscribe<std_msgs::String>(
        "pictures", 100, boost::function<void(const std_msgs::String::ConstPtr&)>([&words](const auto& message) {
          if (words.empty() || words.back() != message->data) words.push_back(message->data);
        }));
  };
  const auto show = [&](int number) {
    std_msgs::String message;
    message.data = std::to_string(number);
    pictures.publish(message);
    sent.push_back(message.data);
  };
  const ros::Subscriber early = listen(heard);
  show(0);
  ASSERT_TRUE(spin_until([&] { return heard == sent; }));
  for (int i = 1; i <= 50; ++i) show(i);
  EXPECT_TRUE(spin_until([&] { return heard == sent; })) << heard.size() << " of " << sent.size();
  std::vector<std::string> heard_late;
  const ros::Subscriber late = listen(heard_late);
  EXPECT_TRUE(spin_until([&] { return heard_late == std::vector<std::string>{"50"}; }));
}

TEST_F(Session, ShowsASkinThatDoesNotMoveToWhoeverComes) {
  for (int i = 0; i < 3; ++i) EXPECT_GT(hear<visualization_msgs::Marker>(topics::simulator_surface)->points.size(), 0u);
}

TEST_F(Session, PublishesAndDrawsWhatTouches) {
  LoadScene::Request request;
  request.path = scenes + "resting_bar.yaml";
  const auto response = ask<LoadScene>(topics::simulator_load, request);
  ASSERT_TRUE(response.success) << response.message;
  Contacts touching;
  ASSERT_TRUE(spin_until([&] {
    touching = *hear<Contacts>(topics::simulator_contacts);
    return !touching.contacts.empty();
  }));
  EXPECT_EQ(touching.header.frame_id, "robot_base");
  const Contact& floor = touching.contacts[0];
  EXPECT_EQ(floor.first, "skin");
  EXPECT_EQ(floor.second, "floor");
  EXPECT_NEAR(floor.force.z, floor.normal_force_n, 1e-3 * floor.normal_force_n);
  EXPECT_GT(floor.normal_force_n, 0.01);
  EXPECT_NEAR(floor.area_m2, 4e-4, 1e-4);
  EXPECT_NEAR(floor.sticking_area_m2 + floor.slipping_area_m2, floor.area_m2, 1e-9);
  EXPECT_NEAR(floor.center.z, -0.1, 1e-3);
  EXPECT_NEAR(floor.normal.z, 1.0, 1e-6);
  EXPECT_GE(floor.largest_penetration_m, 0.0);
  const auto drawn = [&](const std::string& topic, const std::string& ns) {
    const auto array = hear<visualization_msgs::MarkerArray>(topic);
    return std::any_of(array->markers.begin(), array->markers.end(), [&](const auto& shape) { return shape.ns == ns; });
  };
  for (const char* ns : {"contacts", "contact_areas"})
    EXPECT_TRUE(spin_until([&] { return drawn(topics::overlay, ns); })) << ns;
  EXPECT_TRUE(spin_until([&] { return drawn(topics::overlay_labels, "contact_forces"); }));
  EXPECT_TRUE(drawn(topics::simulator_obstacles, "floor"));
  const auto obstacles = hear<visualization_msgs::MarkerArray>(topics::simulator_obstacles);
  const auto rock = std::find_if(obstacles->markers.begin(), obstacles->markers.end(),
                                 [](const auto& shape) { return shape.ns == "rock"; });
  ASSERT_NE(rock, obstacles->markers.end());
  EXPECT_EQ(rock->type, visualization_msgs::Marker::TRIANGLE_LIST);
  EXPECT_EQ(rock->points.size() % 3, 0u);
  EXPECT_GE(rock->points.size(), 72u) << "outside and hollow";
  for (const geometry_msgs::Point& at : rock->points) EXPECT_GT(at.x, 0.3);
  request.path = scenes + "cable_bar.yaml";
  EXPECT_TRUE(ask<LoadScene>(topics::simulator_load, request).success);
  EXPECT_FALSE(drawn(topics::simulator_obstacles, "floor"));
}

TEST_F(Session, CountsACommandForAnActuatorThatDoesNotExist) {
  ActuatorCommand command;
  command.names = {"tail"};
  command.values = {0.9};
  expect_counted(command);
}

TEST_F(Session, RefusesACommandThatNamesAnActuatorTwice) {
  const auto before = hear<ActuatorState>(topics::simulator_actuators);
  ActuatorCommand command;
  command.names = {"left", "left"};
  command.values = {0.95, 0.96};
  expect_counted(command);
  EXPECT_EQ(hear<ActuatorState>(topics::simulator_actuators)->commands, before->commands);
}

TEST_F(Session, RefusesAWholeCommandForOneBadValue) {
  const auto before = hear<ActuatorState>(topics::simulator_actuators);
  ActuatorCommand command;
  command.names = {"left", "right"};
  command.values = {0.95, NAN};
  expect_counted(command);
  EXPECT_EQ(hear<ActuatorState>(topics::simulator_actuators)->commands, before->commands);
}

}  // namespace
}  // namespace soft_robot_lab
