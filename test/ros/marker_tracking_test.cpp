// SPDX-License-Identifier: BSD-3-Clause
// The tracker behind messages: drawn images of two cameras as realsense2_camera would send them.
#include "ros/tracking/marker_tracking.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "ros/messages/conversions.h"
#include "ros/messages/image_messages.h"
#include "ros/tracking/tracker_parameters.h"
#include "perception/tracking/drawn_scene.h"

namespace soft_robot_lab {
namespace {

using Results = std::vector<MarkerTracking::Result>;

constexpr char settings_yaml[] =
    "detector: {colours: {blue: [{hue_deg: [200, 260], saturation: [0.45, 1], value: [0.12, 1]}]}}\n";
const Eigen::Vector3d lower_m(0, -0.01, -0.08), upper_m(0, -0.01, -0.03);

std::vector<TrackerCamera> two_cameras() {
  return {test::camera_at("left", {-0.2, -0.5, -0.1}, {0, 0, -0.05}),
          test::camera_at("right", {0.2, -0.5, -0.1}, {0, 0, -0.05})};
}

MarkerTracking make_tracking() {
  TrackingOptions options;
  options.cameras = {"left", "right"};
  MarkerTracking tracking(options, parse_tracker(settings_yaml, "test"), {{"upper", upper_m}, {"lower", lower_m}});
  std::vector<CameraPose> poses;
  for (const TrackerCamera& camera : two_cameras()) poses.push_back({camera.name, camera.world_from_camera, {}});
  tracking.set_poses(poses);
  return tracking;
}

Eigen::Vector3d lower_at(double time_s) { return lower_m + Eigen::Vector3d(0.02 * time_s, 0, 0); }

FrameMessages messages(const TrackerCamera& camera, int index) {
  const double stamp_s = 1 + index / 30.0;
  return frame_messages(test::film(camera, {{upper_m}, {lower_at(stamp_s - 1)}}, stamp_s), camera.model,
                        ros::Time(stamp_s));
}

MarkerObservations simulated(int index) {
  MarkerObservations message;
  message.header.stamp = ros::Time(1 + index / 30.0);
  message.names = {"lower", "upper"};
  message.positions = {to_message(lower_at(index / 30.0) + Eigen::Vector3d(0.002, 0, 0)), to_message(upper_m)};
  return message;
}

void append(Results& all, Results more) {
  for (auto& result : more) all.push_back(std::move(result));
}

TEST(MarkerTracking, TakesNamesOfTopicsForCamerasAndEachOnce) {
  const auto refusal = [](const std::vector<std::string>& cameras) -> std::string {
    TrackingOptions options;
    options.cameras = cameras;
    try {
      options.validate();
      return "";
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
  };
  EXPECT_EQ(refusal({"left", "/lab/right_2"}), "");
  EXPECT_EQ(refusal({"left", "right", "left"}), "cameras: 'left' is named twice");
  for (const std::string name : {"", "../x", "1x", "a b", "it's", "gr\u00f6\u00dfe"})
    EXPECT_EQ(refusal({"left", name}),
              "cameras: '" + name + "' begins no topic; allowed: a letter, then letters, digits, _ and /");
}

TEST(MarkerTracking, FindsTheMarkersOfTwoCameras) {
  MarkerTracking tracking = make_tracking();
  Results results;
  for (int i = 0; i < 3; ++i)
    for (const TrackerCamera& camera : two_cameras()) {
      const FrameMessages frame = messages(camera, i);
      tracking.add_info(camera.name, frame.info);
      append(results, tracking.add(rgbd_frame(camera.name, frame.colour, frame.depth)));
    }
  ASSERT_EQ(results.size(), 3u);
  const MarkerObservations& last = results.back().observations;
  EXPECT_EQ(last.header.frame_id, "robot_base");
  EXPECT_EQ(last.header.stamp, ros::Time(1 + 2 / 30.0));
  EXPECT_EQ(last.names, (std::vector<std::string>{"upper", "lower"}));
  EXPECT_EQ(last.covariances.size(), 18u);
  EXPECT_EQ(last.sources, (std::vector<std::uint8_t>{MarkerObservations::SEEN, MarkerObservations::SEEN}));
  EXPECT_LT((position_of(last, "upper") - upper_m).norm(), 2e-4);
  EXPECT_LT((position_of(last, "lower") - lower_at(2 / 30.0)).norm(), 2e-4);
}

// Equal settings change no digit, others count from the next frame on.
TEST(MarkerTracking, TakesOtherSettingsWhileItTracks) {
  const auto markers_after = [](const std::vector<double>& gates) {
    MarkerTracking tracking = make_tracking();
    Results results;
    for (int i = 0; i < 4; ++i) {
      for (const TrackerCamera& camera : two_cameras()) {
        const FrameMessages frame = messages(camera, i);
        tracking.add_info(camera.name, frame.info);
        append(results, tracking.add(rgbd_frame(camera.name, frame.colour, frame.depth)));
      }
      if (i != 1) continue;
      for (const double seen_sigma_m : gates) {
        TrackerSettings settings = parse_tracker(settings_yaml, "test");
        settings.motion.seen_sigma_m = seen_sigma_m;
        tracking.set_settings(settings);
      }
    }
    return results.back().observations;
  };
  const MarkerObservations untouched = markers_after({}), same = markers_after({0.002});
  EXPECT_EQ(same.positions, untouched.positions);
  EXPECT_EQ(same.covariances, untouched.covariances);
  EXPECT_EQ(same.sources, (std::vector<std::uint8_t>{MarkerObservations::SEEN, MarkerObservations::SEEN}));
  const MarkerObservations strict = markers_after({1e-5});
  EXPECT_EQ(strict.sources,
            (std::vector<std::uint8_t>{MarkerObservations::INTERPOLATED, MarkerObservations::INTERPOLATED}));
}

const dynamic_reconfigure::DoubleParameter& parameter(const dynamic_reconfigure::Config& config,
                                                      const std::string& name) {
  for (const auto& each : config.doubles)
    if (each.name == name) return each;
  throw std::out_of_range(name);
}

dynamic_reconfigure::Config request_of(const std::string& name, double value) {
  dynamic_reconfigure::Config request;
  request.doubles.resize(1);
  request.doubles[0].name = name;
  request.doubles[0].value = value;
  return request;
}

TEST(TrackerParameters, HaveTheRangesOfTheFile) {
  const TrackerSettings settings = parse_tracker(settings_yaml, "test");
  const auto description = description_message(settings);
  EXPECT_EQ(parameter(description.min, "motion_gate").value, 1.0);
  EXPECT_EQ(parameter(description.max, "motion_gate").value, 1000.0);
  EXPECT_EQ(parameter(description.dflt, "motion_gate").value, settings.motion.gate);
  EXPECT_EQ(parameter(description.max, "marker_radius_m").value, 0.1);
  for (const auto& each : description.max.doubles) {
    const std::size_t end = each.name.find('_');
    const std::string part = each.name.substr(0, end), key = each.name.substr(end + 1);
    const bool inside = part == "motion" || part == "detector" || part == "depth";
    std::string text = settings_yaml;
    const std::string entry = (inside ? key : each.name) + ": " + std::to_string(2.0 * each.value);
    if (part == "detector")
      text.insert(text.find("{colours") + 1, entry + ", ");
    else
      text += inside ? part + ": {" + entry + "}\n" : entry + "\n";
    EXPECT_THROW(parse_tracker(text, "test"), SettingsError) << text << "a file takes what a running tracker cuts";
  }
}

TEST(TrackerParameters, AreCutToTheirRanges) {
  const TrackerSettings settings = parse_tracker(settings_yaml, "test");
  EXPECT_EQ(with_request(settings, request_of("motion_gate", 30.0)).motion.gate, 30.0);
  EXPECT_EQ(with_request(settings, request_of("motion_gate", 1e9)).motion.gate, 1000.0);
  EXPECT_EQ(with_request(settings, request_of("motion_gate", std::nan(""))).motion.gate, settings.motion.gate);
  EXPECT_EQ(with_request(settings, request_of("gate", 30.0)).motion.gate, settings.motion.gate) << "no such parameter";
  const DetectorSettings wide = with_request(settings, request_of("detector_min_area_px", 9000.0)).detector;
  EXPECT_GT(wide.max_area_px, wide.min_area_px);
  EXPECT_GT(with_request(settings, request_of("detector_min_contrast", 0.0)).detector.min_contrast, 0.0);
}

// Images lag behind the simulation: one of before may come after the simulation's clock was set back.
TEST(MarkerTracking, GoesOnWhereTheClockIsSetBack) {
  MarkerTracking tracking = make_tracking();
  const TrackerCamera camera = two_cameras().front();
  tracking.add_info(camera.name, messages(camera, 0).info);
  const auto see = [&](int index, double shift_s) {
    FrameMessages frame = messages(camera, index);
    for (auto* image : {&frame.colour, &frame.depth}) image->header.stamp += ros::Duration(shift_s);
    Results results = tracking.add(rgbd_frame(camera.name, frame.colour, frame.depth));
    append(results, tracking.finish());
    return results.size() == 1 && results[0].report.updated;
  };
  EXPECT_TRUE(see(0, 1.0e9));
  tracking.add_simulated(simulated(0));
  EXPECT_TRUE(see(1, 1.0e9));
  EXPECT_TRUE(see(0, 0.0));
  EXPECT_TRUE(see(1, 0.0));
}

// A recording plays in another order, and faster than its session ran.
TEST(MarkerTracking, GivesTheSameInWhateverOrderMessagesCome) {
  const std::vector<TrackerCamera> cameras = two_cameras();
  Results live, replayed;
  MarkerTracking first = make_tracking(), second = make_tracking();
  for (const TrackerCamera& camera : cameras)
    for (MarkerTracking* tracking : {&first, &second}) tracking->add_info(camera.name, messages(camera, 0).info);
  for (int i = 0; i < 3; ++i) {
    first.add_simulated(simulated(i));
    for (const TrackerCamera& camera : cameras) {
      const FrameMessages frame = messages(camera, i);
      append(live, first.add(rgbd_frame(camera.name, frame.colour, frame.depth)));
    }
  }
  for (int i = 0; i < 3; ++i) second.add_simulated(simulated(i));
  for (const std::string name : {"right", "left"})
    for (int i = 0; i < 3; ++i) {
      const FrameMessages frame = messages(cameras[name == "left" ? 0 : 1], i);
      append(replayed, second.add(rgbd_frame(name, frame.colour, frame.depth)));
    }
  append(live, first.finish());
  append(replayed, second.finish());
  ASSERT_EQ(live.size(), 3u);
  ASSERT_EQ(replayed.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(live[i].observations, replayed[i].observations) << i;
}

// From whatever step a recording begins with, over steps that it lacks, and over a calibration.
TEST(MarkerTracking, RepeatsItsStepsToTheLastDigit) {
  const std::vector<TrackerCamera> cameras = two_cameras();
  MarkerTracking session = make_tracking();
  Results live;
  for (const TrackerCamera& camera : cameras) session.add_info(camera.name, messages(camera, 0).info);
  for (int i = 0; i < 9; ++i) {
    session.add_simulated(simulated(i));
    if (i == 6)
      session.set_poses({{"left", test::camera_at("left", {-0.201, -0.5, -0.1}, {0, 0, -0.05}).world_from_camera, {}}});
    for (const TrackerCamera& camera : cameras) {
      const FrameMessages frame = messages(camera, i);
      if (i != 4 || camera.name == "left")
        append(live, session.add(rgbd_frame(camera.name, frame.colour, frame.depth)));
    }
  }
  append(live, session.finish());
  ASSERT_EQ(live.size(), 9u);
  TrackingOptions options;
  options.cameras = {"left", "right"};
  MarkerTracking replay(options, parse_tracker(settings_yaml, "test"), {{"upper", upper_m}, {"lower", lower_m}});
  for (const std::size_t i : {2u, 3u, 4u, 6u, 7u, 8u}) {
    EXPECT_EQ(replay.follows(live[i].step), i != 2 && i != 6) << i;
    const auto again = replay.repeat(live[i].step, live[i].frames);
    EXPECT_EQ(again.observations, live[i].observations) << i;
    EXPECT_EQ(again.step, live[i].step) << i;
  }
  TrackerUpdateLog broken = live[8].step;
  broken.world_from_camera.pop_back();
  EXPECT_THROW(replay.repeat(broken, live[8].frames), std::invalid_argument);
}

TEST(MarkerTracking, CountsFramesOfCamerasThatItDoesNotKnowYet) {
  MarkerTracking tracking = make_tracking();
  const FrameMessages frame = messages(two_cameras()[0], 0);
  EXPECT_TRUE(tracking.add(rgbd_frame("left", frame.colour, frame.depth)).empty());
  EXPECT_EQ(tracking.unusable_frames(), 1);
  EXPECT_TRUE(tracking.cameras().empty());
}

TEST(MarkerTracking, GoesOnWithTheOtherCamera) {
  MarkerTracking tracking = make_tracking();
  Results results;
  for (int i = 0; i < 6; ++i)
    for (const TrackerCamera& camera : two_cameras()) {
      FrameMessages frame = messages(camera, i);
      tracking.add_info(camera.name, frame.info);
      if (camera.name == "left") frame.colour.encoding = "yuv422";
      if (camera.name == "left")
        EXPECT_THROW(tracking.add(rgbd_frame(camera.name, frame.colour, frame.depth)), std::invalid_argument);
      else
        append(results, tracking.add(rgbd_frame(camera.name, frame.colour, frame.depth)));
    }
  append(results, tracking.finish());
  ASSERT_EQ(results.size(), 6u);
  EXPECT_LT((position_of(results.back().observations, "lower") - lower_at(5 / 30.0)).norm(), 1e-3);
}

TEST(ImageMessages, ComeBackAsTheyWere) {
  const TrackerCamera camera = two_cameras()[0];
  const RgbdFrame frame = test::film(camera, {{upper_m}}, 1.5);
  FrameMessages message = frame_messages(frame, camera.model, ros::Time(1.5));
  const RgbdFrame back = rgbd_frame("left", message.colour, message.depth);
  EXPECT_EQ(back.camera, "left");
  EXPECT_DOUBLE_EQ(back.stamp_s, 1.5);
  EXPECT_EQ(cv::norm(back.colour, frame.colour, cv::NORM_INF), 0);
  EXPECT_LT(cv::norm(back.depth_m, frame.depth_m, cv::NORM_INF), 1e-7);
  EXPECT_EQ(back.depth_step_m, 0.001);
  EXPECT_EQ(camera_model(message.info).focal_x_px, camera.model.focal_x_px);

  message.colour.encoding = "bgr8";
  EXPECT_EQ(rgbd_frame("left", message.colour, message.depth).colour.at<cv::Vec3b>(0, 0)[0], test::kDark[2]);
}

TEST(ImageMessages, AreWholeMillimetresOnlyWhereTheDepthsAre) {
  const TrackerCamera camera = two_cameras()[0];
  RgbdFrame frame = test::film(camera, {{upper_m}}, 1.5);
  EXPECT_EQ(frame_messages(frame, camera.model, ros::Time(1.5)).depth.encoding, "16UC1");
  for (const double step_m : {0.0, 0.0001}) {
    frame.depth_step_m = step_m;
    frame.depth_m.at<float>(7, 5) = 0.5994F;
    frame.depth_m.at<float>(7, 6) = 0.59946F;
    const FrameMessages message = frame_messages(frame, camera.model, ros::Time(1.5));
    EXPECT_EQ(message.depth.encoding, "32FC1");
    const RgbdFrame back = rgbd_frame("left", message.colour, message.depth);
    EXPECT_EQ(cv::norm(back.depth_m, frame.depth_m, cv::NORM_INF), 0);
    EXPECT_EQ(back.depth_step_m, 0);
  }
  frame.depth_step_m = 0.002;
  frame.depth_m.at<float>(7, 5) = 70;  // more than 16 bits hold
  const FrameMessages message = frame_messages(frame, camera.model, ros::Time(1.5));
  EXPECT_EQ(message.depth.encoding, "16UC1");
  EXPECT_EQ(rgbd_frame("left", message.colour, message.depth).depth_m.at<float>(7, 5), 0);
}

TEST(ImageMessages, TakeDepthInMetresAndLeaveOutWhatIsNone) {
  const FrameMessages message = messages(two_cameras()[0], 0);
  sensor_msgs::Image metres = message.depth;
  metres.encoding = "32FC1";
  metres.step = 4 * metres.width;
  metres.data.assign(static_cast<std::size_t>(metres.step) * metres.height, 0);
  auto* values = reinterpret_cast<float*>(metres.data.data());
  values[0] = 0.5994F;
  values[1] = std::numeric_limits<float>::quiet_NaN();
  values[2] = std::numeric_limits<float>::infinity();
  values[3] = -1;
  values[4] = 70;
  const cv::Mat depth_m = rgbd_frame("left", message.colour, metres).depth_m;
  EXPECT_EQ(depth_m.at<float>(0, 0), 0.5994F);
  for (int column : {1, 2, 3, 4}) EXPECT_EQ(depth_m.at<float>(0, column), 0);
}

std::string refusal(const sensor_msgs::Image& colour, const sensor_msgs::Image& depth) {
  try {
    rgbd_frame("left", colour, depth);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(ImageMessages, RefuseWhatTheyCannotBe) {
  const FrameMessages good = messages(two_cameras()[0], 0);
  FrameMessages bad = good;
  bad.colour.encoding = "mono8";
  EXPECT_EQ(refusal(bad.colour, good.depth), "colour: encoding 'mono8' is not one of rgb8, bgr8, rgba8, bgra8");
  bad.depth.encoding = "mono8";
  EXPECT_EQ(refusal(good.colour, bad.depth), "depth: encoding 'mono8' is not one of 16UC1, mono16, 32FC1");
  bad = good;
  bad.depth.data.resize(10);
  EXPECT_NE(refusal(good.colour, bad.depth).find("data holds 10 bytes"), std::string::npos);
  bad = good;
  bad.depth.encoding = "32FC1";
  bad.depth.height = 2;
  bad.depth.step = 4 * bad.depth.width + 2;
  EXPECT_NE(refusal(good.colour, bad.depth).find("in rows of 3394"), std::string::npos);
  bad = good;
  bad.colour.width = 0;
  EXPECT_NE(refusal(bad.colour, good.depth).find("0 x 480"), std::string::npos);

  sensor_msgs::CameraInfo info = good.info;
  info.K[0] = 0;
  EXPECT_THROW(camera_model(info), std::invalid_argument);
  info = good.info;
  info.D = {0.1, 0, 0, 0};
  EXPECT_THROW(camera_model(info), std::invalid_argument);
  info.distortion_model = "equidistant";
  info.D = {0.1, 0, 0, 0, 0};
  EXPECT_THROW(camera_model(info), std::invalid_argument);
}

}  // namespace
}  // namespace soft_robot_lab
