// SPDX-License-Identifier: BSD-3-Clause
// design/check, what it shows in rviz, and how programs hear a session and read parameters.
#include <algorithm>
#include <cmath>
#include <future>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <ros/ros.h>
#include <soft_robot_lab/CheckDesign.h>
#include <std_msgs/String.h>
#include <visualization_msgs/Marker.h>

#include "ros/base/topics.h"
#include "ros/nodes/read_parameter.h"
#include "ros/nodes/session_client.h"
#include "session_ears.h"

namespace soft_robot_lab {
namespace {

using visualization_msgs::Marker;
const std::string kScenes = SOFT_ROBOT_LAB_SOURCE "/test/data/scenes/";

CheckDesign::Response check(ros::NodeHandle& node, const std::string& robot, bool show) {
  CheckDesign::Request request;
  request.robot = robot;
  request.show = show;
  return ask<CheckDesign>(node, topics::check_design, request);
}

bool is_orange(const std_msgs::ColorRGBA& colour) { return colour.b < 0.2f * colour.r; }

TEST(DesignCheck, SaysWhereAFinIsTooThinAndColoursItThere) {
  ros::NodeHandle node;
  const CheckDesign::Response answer = check(node, kScenes + "thin_fin.yaml", true);
  ASSERT_TRUE(answer.success) << answer.message;
  EXPECT_FALSE(answer.castable);
  EXPECT_EQ(answer.message, "not castable; fails: thickness");
  EXPECT_NEAR(std::hypot(answer.direction.x, answer.direction.y, answer.direction.z), 1.0, 1e-9);
  const auto place = std::find(answer.tests.begin(), answer.tests.end(), "thickness");
  ASSERT_NE(place, answer.tests.end());
  const auto i = static_cast<std::size_t>(place - answer.tests.begin());
  EXPECT_EQ(answer.passed.at(i), 0);
  EXPECT_EQ(answer.margins.at(i), "1 mm, at least 2 mm");
  EXPECT_NE(answer.reasons.at(i).find(" mm"), std::string::npos) << answer.reasons[i];

  const Marker::ConstPtr skin = hear<Marker>(node, topics::design_casting);
  EXPECT_EQ(skin->header.frame_id, "robot_base");
  ASSERT_EQ(skin->colors.size(), skin->points.size());
  double lowest_orange_m = 1.0;
  for (std::size_t k = 0; k < skin->points.size(); ++k)
    if (is_orange(skin->colors[k])) lowest_orange_m = std::min(lowest_orange_m, skin->points[k].z);
  EXPECT_NEAR(lowest_orange_m, 0.01, 5e-4);  // where the fin begins
}

TEST(DesignCheck, ChecksTheSceneThatRunsAndTakesItsSkinAway) {
  ros::NodeHandle node;
  EXPECT_NE(check(node, "", true).message.find("robot: empty, and no scene runs"), std::string::npos);
  const ros::Publisher scenes = node.advertise<std_msgs::String>(topics::simulator_scene, 1, true);
  std_msgs::String path;
  path.data = kScenes + "hollow_bar.yaml";
  scenes.publish(path);
  CheckDesign::Response answer;
  ASSERT_TRUE(spin_until([&] { return (answer = check(node, "", false)).success; })) << answer.message;
  EXPECT_EQ(hear<Marker>(node, topics::design_casting)->action, Marker::DELETE);
}

TEST(DesignCheck, NamesWhatIsWrongInAFile) {
  ros::NodeHandle node;
  for (const auto& [file, text] : {std::pair{"unknown_key.yaml", "unknown_key.yaml"}, {"none.yaml", "none.yaml"}}) {
    const CheckDesign::Response answer = check(node, kScenes + file, true);
    EXPECT_FALSE(answer.success);
    EXPECT_NE(answer.message.find(text), std::string::npos) << answer.message;
    EXPECT_TRUE(answer.tests.empty());
  }
  EXPECT_EQ(check(node, "unknown_key.yaml", true).message,
            "robot: 'unknown_key.yaml' is no whole path; it must begin with /");
  EXPECT_EQ(check(node, std::string("\0x", 2), true).message, "robot: holds a byte of value 0, as no text does");
}

TEST(RequiredText, NamesAParameterThatIsMissingOrEmpty) {
  const ros::NodeHandle parameters("~");
  const auto refusal = [&] {
    try {
      return required_text(parameters, "rig", "the path of a rig's file");
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
  };
  EXPECT_EQ(refusal(), "rig: missing; give the path of a rig's file");
  parameters.setParam("rig", "");
  EXPECT_EQ(refusal(), "rig: missing; give the path of a rig's file");
  parameters.setParam("rig", 3);
  EXPECT_EQ(refusal().rfind("rig: must be a text", 0), 0u) << refusal();
  parameters.setParam("rig", "motors.yaml");
  EXPECT_EQ(refusal(), "motors.yaml");
}

// A node that starts late hears nothing of /clock at first, then the time of a session that has run for long.
TEST(SessionClient, WaitsWhileTheClockJumps) {
  ros::NodeHandle node;
  ros::Time::setNow(ros::Time(1.0));
  const ros::Publisher said = node.advertise<std_msgs::String>("said_late", 1, true);
  const auto saying = std::async(std::launch::async, [&said] {
    ros::WallDuration(0.3).sleep();
    ros::Time::setNow(ros::Time(1000.0));
    ros::WallDuration(0.5).sleep();
    std_msgs::String text;
    text.data = "here";
    said.publish(text);
  });
  EXPECT_EQ(first_on<std_msgs::String>(node, "said_late").data, "here");
}

}  // namespace
}  // namespace soft_robot_lab
