// SPDX-License-Identifier: BSD-3-Clause
// A running tracker gets what real cameras send on bad days: it says so, and goes on with the other camera.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <dynamic_reconfigure/Reconfigure.h>
#include <gtest/gtest.h>
#include <ros/ros.h>

#include "session_ears.h"
#include "ros/messages/conversions.h"
#include "ros/messages/image_messages.h"
#include "ros/base/topics.h"
#include "ros/nodes/read_parameter.h"
#include "ros/tracking/tracking_input.h"
#include "perception/tracking/drawn_scene.h"

namespace soft_robot_lab {
namespace {

using diagnostic_msgs::DiagnosticStatus;
using test::DrawnMarker;

constexpr double rate_hz = 25;
const Eigen::Vector3d target_m(0, 0, -0.05);
// As in marked_bar.yaml.
const std::map<std::string, Eigen::Vector3d> places_m = {{"first", {-0.005, -0.01, -0.02}},
                                                         {"second", {0.005, -0.01, -0.045}},
                                                         {"third", {-0.005, -0.01, -0.07}},
                                                         {"fourth", {0.005, -0.01, -0.095}}};

std::vector<DrawnMarker> drawn_markers() {
  std::vector<DrawnMarker> markers;
  for (const auto& [name, position_m] : places_m) {
    markers.emplace_back();
    markers.back().position_m = position_m;
    markers.back().radius_m = 0.004;
    markers.back().skin_radius_m = 0.009;
  }
  return markers;
}

// As in front_poses.yaml.
TrackerCamera camera(const std::string& name) {
  const double x_m = name == "left" ? -0.2 : name == "right" ? 0.2 : 0;
  return test::camera_at(name, {x_m, -0.5, -0.1}, target_m);
}

FrameMessages film(const TrackerCamera& camera) {
  return frame_messages(test::film(camera, drawn_markers(), 0), camera.model, ros::Time());
}

// Drawn once for all tests.
const FrameMessages& still(const std::string& name) {
  static std::map<std::string, FrameMessages> drawn;
  const auto known = drawn.find(name);
  return known != drawn.end() ? known->second : drawn.emplace(name, film(camera(name))).first->second;
}

class TrackedCameras : public testing::Test {
 protected:
  using Spoil = std::function<bool(FrameMessages&)>;  // whether to send it still

  TrackedCameras() {
    for (const std::string name : {"left", "right", "spare"}) {
      Camera& one = cameras_[name];
      one.frame = still(name);
      one.colour = node_.advertise<sensor_msgs::Image>(colour_topic(name), 5);
      one.depth = node_.advertise<sensor_msgs::Image>(depth_topic(name), 5);
      one.info = node_.advertise<sensor_msgs::CameraInfo>(info_topic(name), 5);
    }
    markers_ = node_.subscribe<MarkerObservations>(
        topics::tracker_markers, 10,
        boost::function<void(const MarkerObservations::ConstPtr&)>([this](const auto& message) { latest_ = message; }));
    diagnostics_ = node_.subscribe<diagnostic_msgs::DiagnosticArray>(
        "/diagnostics", 10,
        boost::function<void(const diagnostic_msgs::DiagnosticArray::ConstPtr&)>([this](const auto& message) {
          for (const DiagnosticStatus& status : message->status) statuses_[status.name] = status;
        }));
    if (!spin_until([&] { return cameras_["right"].colour.getNumSubscribers() > 0; }))
      throw std::runtime_error("no tracker");
  }

  // What a camera's frames become from now on.
  void spoil(const std::string& name, const Spoil& how) { spoils_[name] = how; }
  void move_right_camera(const Eigen::Vector3d& by_m) {
    TrackerCamera moved = camera("right");
    moved.world_from_camera.translation() += by_m;
    cameras_["right"].frame = film(moved);
  }

  bool play_until(const std::function<bool()>& condition, double limit_s = 10) {
    const ros::WallTime limit = ros::WallTime::now() + ros::WallDuration(limit_s);
    statuses_.clear();
    for (ros::WallRate rate(rate_hz); !condition(); rate.sleep()) {
      if (ros::WallTime::now() >= limit) return false;
      send();
      ros::spinOnce();
    }
    return true;
  }
  void play(double duration_s) {
    play_until([] { return false; }, duration_s);
  }

  // What the tracker says of a camera, or of "tracker" and "places of cameras".
  std::string status(const std::string& name) const {
    const auto at = statuses_.find("tracker: " + name);
    return at == statuses_.end() ? "" : at->second.message;
  }
  bool says(const std::string& name, const std::string& text) const {
    return status(name).find(text) != std::string::npos;
  }

  void expect_markers_in_their_places(double within_m = 1e-3) {
    latest_.reset();
    // A busy machine's frames come late now and then, and what they show is predicted.
    const auto all_seen = [&] {
      return latest_ && std::all_of(latest_->sources.begin(), latest_->sources.end(),
                                    [](auto source) { return source == MarkerObservations::SEEN; });
    };
    ASSERT_TRUE(play_until(all_seen));
    EXPECT_EQ(latest_->names.size(), places_m.size());
    for (const auto& [name, position_m] : places_m)
      EXPECT_LT((position_of(*latest_, name) - position_m).norm(), within_m) << name;
  }

  ros::NodeHandle node_;
  MarkerObservations::ConstPtr latest_;

 private:
  struct Camera {
    FrameMessages frame;
    ros::Publisher colour, depth, info;
  };

  void send() {
    const ros::Time now = ros::Time::now();
    for (auto& [name, one] : cameras_) {
      if (name == "spare" && !spoils_.count(name)) continue;
      FrameMessages frame = one.frame;
      if (spoils_.count(name) && !spoils_.at(name)(frame)) continue;
      frame.colour.header.stamp = frame.depth.header.stamp = frame.info.header.stamp = now;
      if (name != "spare") one.info.publish(frame.info);
      one.colour.publish(frame.colour);
      one.depth.publish(frame.depth);
    }
  }

  std::map<std::string, Camera> cameras_;
  std::map<std::string, Spoil> spoils_;
  std::map<std::string, DiagnosticStatus> statuses_;
  ros::Subscriber markers_, diagnostics_;
};

sensor_msgs::Image metres_that_are_none(const sensor_msgs::Image& depth) {
  sensor_msgs::Image metres = depth;
  metres.encoding = "32FC1";
  metres.step = 4 * metres.width;
  metres.data.resize(static_cast<std::size_t>(metres.step) * metres.height);
  const float none = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t i = 0; i < metres.data.size(); i += 4) std::memcpy(&metres.data[i], &none, 4);
  return metres;
}

TEST_F(TrackedCameras, AreFollowed) {
  EXPECT_TRUE(play_until([&] { return says("left", "its images are used") && says("tracker", "all markers"); }));
  expect_markers_in_their_places(3e-4);
}

// By dynamic_reconfigure: what is too strict is cut to the file's range, and no marker is then surely seen.
TEST_F(TrackedCameras, AreFollowedByOtherNumbersWhereTheseAreChanged) {
  const auto change = [&](double seen_sigma_m) {
    dynamic_reconfigure::Reconfigure::Request request;
    request.config.doubles.resize(1);
    request.config.doubles[0].name = "motion_seen_sigma_m";
    request.config.doubles[0].value = seen_sigma_m;
    for (const auto& number :
         ask<dynamic_reconfigure::Reconfigure>(node_, "tracker/set_parameters", request).config.doubles)
      if (number.name == "motion_seen_sigma_m") return number.value;
    return 0.0;
  };
  expect_markers_in_their_places(3e-4);
  EXPECT_EQ(change(0.0), 1e-5);
  EXPECT_TRUE(play_until([&] { return latest_ && latest_->sources.at(0) == MarkerObservations::INTERPOLATED; }));
  EXPECT_EQ(change(0.002), 0.002);
  EXPECT_TRUE(play_until([&] { return latest_ && latest_->sources.at(0) == MarkerObservations::SEEN; }));
}

TEST_F(TrackedCameras, AreRefusedAndNamedWhereTheirImagesAreWrongAndTheOtherOneServes) {
  const std::map<std::string, Spoil> spoils = {
      {"encoding 'yuv422' is not one of rgb8, bgr8",
       [](FrameMessages& frame) { return frame.colour.encoding = "yuv422", true; }},
      {"colour is 848 x 480 and depth 848 x 240; allowed: alike",
       [](FrameMessages& frame) { return frame.depth.height = 240, true; }},
      {"data holds 100 bytes", [](FrameMessages& frame) { return frame.depth.data.resize(100), true; }},
  };
  for (const auto& [complaint, how] : spoils) {
    spoil("left", how);
    EXPECT_TRUE(play_until([&, text = complaint] { return says("left", text) && says("tracker", text); }))
        << complaint << ", not: " << status("left");
    expect_markers_in_their_places();
  }
}

TEST_F(TrackedCameras, MaySendNoDepth) {
  for (const Spoil& how : {Spoil([](FrameMessages& frame) {
                             frame.depth = metres_that_are_none(frame.depth);
                             return true;
                           }),
                           Spoil([](FrameMessages& frame) {
                             std::fill(frame.depth.data.begin(), frame.depth.data.end(), std::uint8_t{0});
                             return true;
                           })}) {
    spoil("left", how);
    play(0.5);
    expect_markers_in_their_places();
  }
}

TEST_F(TrackedCameras, AreNamedWhereTheirLensIsNotKnown) {
  spoil("spare", [](FrameMessages&) { return true; });
  EXPECT_TRUE(play_until([&] { return says("spare", "nothing usable came on spare/color/camera_info"); }))
      << status("spare");
  expect_markers_in_their_places();
}

TEST(NodeParameters, AreWholeWhereTheyCount) {
  const ros::NodeHandle node("~");
  int count = 7;
  for (const double value : {1.5, 1e300, -1e10, std::nan("")}) {
    node.setParam("count", value);
    try {
      read_parameter(node, "count", count);
      FAIL() << value;
    } catch (const std::invalid_argument& error) {
      EXPECT_STREQ(error.what(), "count: must be a whole number");
    }
  }
  EXPECT_EQ(count, 7);
  node.setParam("count", 3.0);
  EXPECT_TRUE(read_parameter(node, "count", count));
  EXPECT_EQ(count, 3);
}

TEST_F(TrackedCameras, AreNamedWhenTheyAreUnplugged) {
  spoil("left", [](FrameMessages&) { return false; });
  EXPECT_TRUE(play_until([&] { return says("left", "nothing on left/color/image_raw"); })) << status("left");
  expect_markers_in_their_places();
  spoil("left", [](FrameMessages&) { return true; });
  EXPECT_TRUE(play_until([&] { return says("left", "its images are used"); })) << status("left");
}

TEST_F(TrackedCameras, AreNamedWhenTheyWereKnocked) {
  // The spare one alone is left out.
  ASSERT_TRUE(play_until([&] { return says("places of cameras", "sees too: spare"); })) << status("places of cameras");
  play(4);
  move_right_camera({0.005, 0, 0});
  EXPECT_TRUE(play_until([&] { return says("places of cameras", "right was moved"); })) << status("places of cameras");
}

}  // namespace
}  // namespace soft_robot_lab
