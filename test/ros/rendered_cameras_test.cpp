// SPDX-License-Identifier: BSD-3-Clause
// A session with a rendered camera: what it publishes, and that it films what the simulator publishes.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <soft_robot_lab/MoveCamera.h>
#include <std_srvs/SetBool.h>
#include <tf2_msgs/TFMessage.h>

#include "session_ears.h"
#include "ros/messages/conversions.h"
#include "ros/base/topics.h"
#include "soft_robot_lab/perception/tracking/camera_model.h"

namespace soft_robot_lab {
namespace {

const Eigen::Vector3d ball_m(0.08, 0, -0.1);  // of test/data/cameras/bar.yaml
constexpr double ball_radius_m = 0.01;
const std::array<int, 3> ball_white{255, 255, 255}, box_black{0, 0, 0};

struct Frame {
  sensor_msgs::Image::ConstPtr colour, depth;
  sensor_msgs::CameraInfo::ConstPtr colour_info, depth_info;
  std::optional<Eigen::Vector3d> tip_m;  // at its stamp
  bool whole() const { return colour && depth && colour_info && depth_info && tip_m; }
};

class RenderedCameras : public testing::Test {
 protected:
  RenderedCameras() {
    // Kept for the simulator, which may connect after the controller has.
    commands_ = node_.advertise<ActuatorCommand>(topics::actuator_command, 1, true);
    listen<sensor_msgs::Image>("eye/color/image_raw", [](Frame& f, const auto& m) { f.colour = m; });
    listen<sensor_msgs::Image>("eye/aligned_depth_to_color/image_raw", [](Frame& f, const auto& m) { f.depth = m; });
    listen<sensor_msgs::CameraInfo>("eye/color/camera_info", [](Frame& f, const auto& m) { f.colour_info = m; });
    listen<sensor_msgs::CameraInfo>("eye/aligned_depth_to_color/camera_info",
                                    [](Frame& f, const auto& m) { f.depth_info = m; });
    listen<MarkerObservations>(topics::simulator_markers,
                               [](Frame& f, const auto& m) { f.tip_m = position_of(*m, "tip"); });
    subscribers_.push_back(node_.subscribe<tf2_msgs::TFMessage>(
        "/tf_static", 10, boost::function<void(const tf2_msgs::TFMessage::ConstPtr&)>([this](const auto& m) {
          for (const auto& transform : m->transforms)
            if (transform.child_frame_id == "truth/eye_color_optical_frame") pose_ = transform;
        })));
    if (!spin_until([&] { return pose_.has_value(); })) throw std::runtime_error("no true pose");
  }

  template <typename Message>
  void listen(const std::string& topic, void (*keep)(Frame&, const typename Message::ConstPtr&)) {
    subscribers_.push_back(node_.subscribe<Message>(
        topic, 100, boost::function<void(const typename Message::ConstPtr&)>([this, keep](const auto& message) {
          keep(frames_[message->header.stamp], message);
        })));
  }

  // The next whole frame.
  Frame film() {
    frames_.clear();
    const auto first_whole = [&] {
      return std::find_if(frames_.begin(), frames_.end(), [](const auto& f) { return f.second.whole(); });
    };
    if (!spin_until([&] { return first_whole() != frames_.end(); })) throw std::runtime_error("no whole frame");
    return first_whole()->second;
  }

  // A frame that was taken after what was asked for just now.
  Frame film_anew() {
    const ros::Time asked = ros::Time::now() + ros::Duration(0.1);
    Frame frame = film();
    while (frame.colour->header.stamp <= asked) frame = film();
    return frame;
  }

  Eigen::Vector3d in_camera_m(const Eigen::Vector3d& world_m) const {
    const auto& t = pose_->transform.translation;
    const auto& q = pose_->transform.rotation;
    return Eigen::Quaterniond(q.w, q.x, q.y, q.z).conjugate() * (world_m - Eigen::Vector3d(t.x, t.y, t.z));
  }

  struct Pixel {
    std::array<int, 3> colour;
    double depth_m;
  };
  Pixel at(const Frame& frame, const Eigen::Vector3d& world_m) const {
    const Eigen::Vector3d point_m = in_camera_m(world_m);
    const auto& k = frame.colour_info->K;
    const auto column = static_cast<std::size_t>(std::lround(k[0] * point_m.x() / point_m.z() + k[2]));
    const auto row = static_cast<std::size_t>(std::lround(k[4] * point_m.y() / point_m.z() + k[5]));
    const std::uint8_t* rgb = &frame.colour->data.at(row * frame.colour->step + 3 * column);
    const std::uint8_t* mm = &frame.depth->data.at(row * frame.depth->step + 2 * column);
    return {{rgb[0], rgb[1], rgb[2]}, 1e-3 * (mm[0] + 256 * mm[1])};
  }

  void expect_marker_in_its_place(const Frame& frame) const {
    const Pixel pixel = at(frame, *frame.tip_m);
    // The face turns steep as the bar bends, so a part of the pixel may be silicone.
    EXPECT_GT(pixel.colour[2], 3 * std::max(pixel.colour[0], pixel.colour[1]));
    // Half a millimetre of rounding, and half a pixel (0.5 mm) on a face that turns steep as the bar bends.
    EXPECT_NEAR(pixel.depth_m, in_camera_m(*frame.tip_m).z(), 2.5e-3);
  }

  void pull(double contraction) {
    ActuatorCommand command;
    command.names = {"right"};
    command.values = {contraction};
    commands_.publish(command);
  }

  ros::NodeHandle node_;
  std::optional<geometry_msgs::TransformStamped> pose_;

 private:
  std::map<ros::Time, Frame> frames_;
  ros::Publisher commands_;
  std::vector<ros::Subscriber> subscribers_;
};

TEST_F(RenderedCameras, PublishAsRealsense2CameraDoes) {
  const Frame frame = film();
  EXPECT_EQ(frame.colour->encoding, "rgb8");
  EXPECT_EQ(frame.depth->encoding, "16UC1");
  EXPECT_EQ(frame.colour->step, 3u * 424);
  EXPECT_EQ(frame.depth->step, 2u * 424);
  const CameraModel model = d415_camera(424, 240);
  for (const auto& image : {frame.colour, frame.depth}) {
    EXPECT_EQ(image->width, 424u);
    EXPECT_EQ(image->height, 240u);
    EXPECT_EQ(image->data.size(), image->step * image->height);
    EXPECT_EQ(image->header.frame_id, "eye_color_optical_frame");
    EXPECT_EQ(image->is_bigendian, 0);
  }
  for (const auto& info : {frame.colour_info, frame.depth_info}) {
    EXPECT_EQ(info->header.frame_id, "eye_color_optical_frame");
    EXPECT_EQ(info->width, 424u);
    EXPECT_EQ(info->height, 240u);
    EXPECT_EQ(info->distortion_model, "plumb_bob");
    EXPECT_EQ(info->D, std::vector<double>(5, 0.0));
    EXPECT_EQ(info->K[0], model.focal_x_px);
    EXPECT_EQ(info->K[2], model.centre_x_px);
    EXPECT_EQ(info->P[5], model.focal_y_px);
    EXPECT_EQ(info->P[6], model.centre_y_px);
    EXPECT_EQ(info->P[10], 1);
  }
  EXPECT_EQ(pose_->header.frame_id, "world");
}

TEST_F(RenderedCameras, FilmEachTenthOfASecondAtMostOnce) {
  const auto tenth = [](const Frame& frame) { return std::floor(frame.colour->header.stamp.toSec() * 10 + 1e-6); };
  double last = tenth(film());
  for (int i = 0; i < 3; ++i) {
    const double next = tenth(film());
    EXPECT_GT(next, last);
    last = next;
  }
}

TEST_F(RenderedCameras, ShowAMarkerWhereItIsAtRestAndMoving) {
  const Frame at_rest = film();
  expect_marker_in_its_place(at_rest);
  pull(0.8);
  const auto away = [&] {  // on a busy machine frames from before come first
    const Frame frame = film();
    expect_marker_in_its_place(frame);
    return (*frame.tip_m - *at_rest.tip_m).norm() > 0.01;
  };
  EXPECT_TRUE(spin_until(away));
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(away());
  pull(1.0);
  const auto back = [&] { return (*film().tip_m - *at_rest.tip_m).norm() < 0.001; };
  EXPECT_TRUE(spin_until(back));
}

TEST_F(RenderedCameras, ShowAndHideCalibrationBalls) {
  EXPECT_EQ(at(film(), ball_m).colour, box_black);
  std_srvs::SetBool::Request request;
  request.data = true;
  EXPECT_TRUE(ask<std_srvs::SetBool>(node_, topics::show_balls, request).success);
  const Pixel ball = at(film_anew(), ball_m);
  EXPECT_EQ(ball.colour, ball_white);
  EXPECT_NEAR(ball.depth_m, in_camera_m(ball_m).z() - ball_radius_m, 2e-3);
  request.data = false;
  EXPECT_TRUE(ask<std_srvs::SetBool>(node_, topics::show_balls, request).success);
  EXPECT_EQ(at(film_anew(), ball_m).colour, box_black);
}

TEST_F(RenderedCameras, MoveOnRequest) {
  const geometry_msgs::TransformStamped before = *pose_;
  MoveCamera::Request request;
  request.name = "eye";
  request.translation.x = 0.03;
  request.rotation.z = 0.05;
  const auto response = ask<MoveCamera>(node_, topics::move_camera, request);
  EXPECT_TRUE(response.success) << response.message;
  ASSERT_TRUE(spin_until([&] { return pose_->transform.translation.x != before.transform.translation.x; }));
  EXPECT_NEAR(pose_->transform.translation.x, before.transform.translation.x + 0.03, 1e-12);
  expect_marker_in_its_place(film_anew());
  request.translation.x = -0.03;
  request.rotation.z = -0.05;
  EXPECT_TRUE(ask<MoveCamera>(node_, topics::move_camera, request).success);
  ASSERT_TRUE(spin_until([&] { return pose_->transform.translation.x < before.transform.translation.x + 0.01; }));
  EXPECT_NEAR(pose_->transform.rotation.w, before.transform.rotation.w, 1e-9);
}

TEST_F(RenderedCameras, RefuseBadMoves) {
  MoveCamera::Request request;
  request.name = "nose";
  const auto unknown = ask<MoveCamera>(node_, topics::move_camera, request);
  EXPECT_FALSE(unknown.success);
  EXPECT_NE(unknown.message.find("name: 'nose' is not one of eye"), std::string::npos) << unknown.message;
  request.name = "eye";
  request.translation.y = NAN;
  const auto nowhere = ask<MoveCamera>(node_, topics::move_camera, request);
  EXPECT_FALSE(nowhere.success);
  EXPECT_NE(nowhere.message.find("translation"), std::string::npos) << nowhere.message;
  request.translation.y = 1e19;
  EXPECT_FALSE((ask<MoveCamera>(node_, topics::move_camera, request).success)) << "too far for any image";
  request.translation.y = 0.0;
  request.rotation.x = 1e300;
  EXPECT_FALSE((ask<MoveCamera>(node_, topics::move_camera, request).success)) << "no turn";
  expect_marker_in_its_place(film_anew());
}

TEST_F(RenderedCameras, TellWhatFramesCost) {
  film();
  std::map<std::string, double> values;
  using Diagnostics = diagnostic_msgs::DiagnosticArray;
  // Of all nodes that send some: the next message may be another's each time.
  const ros::Subscriber subscriber = node_.subscribe<Diagnostics>(
      "/diagnostics", 10, boost::function<void(const Diagnostics::ConstPtr&)>([&](const auto& diagnostics) {
        for (const auto& status : diagnostics->status)
          if (status.name.find("rendered cameras") != std::string::npos)
            for (const auto& value : status.values) values[value.key] = std::stod(value.value);
      }));
  ASSERT_TRUE(spin_until([&] { return values["eye frames"] > 0; }));
  EXPECT_GT(values["eye CPU time per frame [ms]"], 0);
  EXPECT_EQ(values.count("eye dropped frames"), 1u);
}

}  // namespace
}  // namespace soft_robot_lab
