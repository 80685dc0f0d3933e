// SPDX-License-Identifier: BSD-3-Clause
// A recording of a session whose recorder lost an image.
#include "ros/recording/replay_tracking.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>
#include <rosbag/bag.h>
#include <std_msgs/String.h>
#include <unistd.h>

#include "ros/messages/conversions.h"
#include "ros/messages/image_messages.h"
#include "ros/recording/recorded_frames.h"
#include "ros/base/topics.h"
#include "ros/tracking/tracker_parameters.h"
#include "perception/tracking/drawn_scene.h"

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;

const Eigen::Vector3d tip_m(0, -0.01, -0.05);
constexpr int steps = 8, lost = 4;

class Replay : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("soft_robot_lab_replay_" + std::to_string(getpid()));
    fs::create_directories(folder_);
    options_.tracker = folder_ / "tracker.yaml";
    std::ofstream(options_.tracker)
        << "detector: {colours: {blue: [{hue_deg: [200, 260], saturation: [0.45, 1], value: [0.12, 1]}]}}\n";
    options_.tracking.cameras = {"eye"};
  }
  void TearDown() override { fs::remove_all(folder_); }
  ReplaySummary replay() const { return replay_tracking(options_, path("session.bag"), path("output.bag")); }
  std::string path(const char* name) const { return folder_ / name; }

  // The tip moves; the session's tracker has seen a frame before the recording begins, and reports `reported_m` off.
  // `tuned`: a number of the tracker is changed before the last step but one.
  void record(double reported_m, bool images, bool tuned = false) const {
    const TrackerCamera camera = test::camera_at("eye", {-0.2, -0.5, -0.1}, tip_m);
    MarkerTracking session(options_.tracking, load_tracker(options_.tracker), {{"tip", tip_m}});
    session.set_poses({{"eye", camera.world_from_camera, {}}});
    rosbag::Bag bag(path("session.bag"), rosbag::bagmode::Write);
    TrackerSettings settings = load_tracker(options_.tracker);
    const auto publish_settings = [&](double time_s) {
      bag.write(std::string("/") + tracker_updates, ros::Time(time_s), config_message(settings));
    };
    publish_settings(100.0);
    for (int i = -1; i <= steps; ++i) {
      if (tuned && i == steps - 1) {
        settings.motion.acceleration_m_s2 = 20.0;
        session.set_settings(settings);
        publish_settings(100 + (i - 0.5) / 30.0);
      }
      const double stamp_s = 100 + i / 30.0;
      const ros::Time stamp(stamp_s);
      const FrameMessages frame = frame_messages(
          test::film(camera, {{tip_m + Eigen::Vector3d(0.002 * i, 0, 0)}}, stamp_s), camera.model, stamp);
      session.add_info("eye", frame.info);
      auto results = session.add(rgbd_frame("eye", frame.colour, frame.depth));
      if (i < 0) continue;
      if (images && i != lost) bag.write("/" + colour_topic("eye"), stamp, frame.colour);
      if (images) bag.write("/" + depth_topic("eye"), stamp, frame.depth);
      MarkerObservations simulated;
      simulated.header.stamp = stamp;
      simulated.names = {"tip"};
      simulated.positions = {to_message(tip_m)};
      simulated.sources = {MarkerObservations::SIMULATED};
      bag.write("/simulator/markers", stamp, simulated);
      for (auto& result : results) {
        bag.write("/tracker/steps", stamp, result.step);
        result.observations.positions[0].x += reported_m;
        bag.write("/tracker/markers", stamp, result.observations);
      }
    }
  }

  fs::path folder_;
  TrackingInputOptions options_;
};

TEST_F(Replay, RepeatsTheSessionAndCountsWhatTheRecordingLacks) {
  record(0.0, true);
  const ReplaySummary summary = replay();
  EXPECT_TRUE(summary.repeated);
  EXPECT_EQ(summary.without_images, 1);
  EXPECT_EQ(summary.resumed, 2);  // the first, and that after the lost one
  EXPECT_EQ(summary.written, steps);
  EXPECT_EQ(summary.markers_alike, steps);
  EXPECT_EQ(summary.markers_other, 0);
}

TEST_F(Replay, ChangesTheTrackersNumbersWhereTheSessionDid) {
  record(0.0, true, true);
  EXPECT_EQ(replay().markers_alike, steps);
}

TEST_F(Replay, TellsWhatIsNotAsInTheSession) {
  record(1e-15, true);
  const ReplaySummary summary = replay();
  EXPECT_EQ(summary.markers_alike, 0);
  EXPECT_EQ(summary.markers_other, steps);
}

TEST_F(Replay, RefusesARecordingWithoutImages) {
  record(0.0, false);
  EXPECT_THROW(replay(), std::runtime_error);
}

TEST_F(Replay, WritesOverNothingThatItReads) {
  record(0, true);
  fs::create_symlink(path("session.bag"), path("link.bag"));
  const auto bag_bytes = fs::file_size(path("session.bag")), tracker_bytes = fs::file_size(path("tracker.yaml"));
  for (const char* output : {"session.bag", "link.bag", "none/../session.bag", "tracker.yaml"}) {
    try {
      replay_tracking(options_, path("session.bag"), path(output));
      FAIL() << output;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find("would be written over"), std::string::npos) << error.what();
    }
    EXPECT_EQ(fs::file_size(path("session.bag")), bag_bytes) << output;
    EXPECT_EQ(fs::file_size(path("tracker.yaml")), tracker_bytes) << output;
  }
  EXPECT_GT(replay().written, 0);
}

TEST_F(Replay, RefusesTopicsOfOtherTypes) {
  for (const std::string& topic : {std::string(topics::tracker_steps), std::string(topics::tracker_markers),
                                   std::string(topics::simulator_markers), std::string(topics::reality_gap),
                                   colour_topic("eye"), depth_topic("eye")}) {
    record(0.0, true);
    rosbag::Bag(path("session.bag"), rosbag::bagmode::Append).write("/" + topic, ros::Time(100.1), std_msgs::String());
    EXPECT_THROW(replay(), std::runtime_error) << topic;
  }
}

// A recording of a bare camera, which its owner may have made in any way.
class BareReplay : public Replay {
 protected:
  static constexpr int frames = 6;

  void SetUp() override {
    Replay::SetUp();
    setenv("ROS_PACKAGE_PATH", SOFT_ROBOT_LAB_SOURCE ":/usr/share", 1);  // where plugins are looked for
    options_.scene = SOFT_ROBOT_LAB_SOURCE "/test/data/scenes/two_markers.yaml";
    options_.poses = folder_ / "poses.yaml";
    write_camera_poses(options_.poses, {{"eye", camera_.world_from_camera, {}}});
  }

  // `spoil` may change what was filmed, and `spoil_messages` what is written; a topic without a name is left out.
  void film(
      const std::function<void(RgbdFrame&)>& spoil = [](RgbdFrame&) {},
      const std::function<void(FrameMessages&)>& spoil_messages = [](FrameMessages&) {},
      const std::string& colour = "eye/color/image_raw") const {
    rosbag::Bag bag(path("session.bag"), rosbag::bagmode::Write);
    RgbdFrame frame = test::film(camera_, {{places_m[0]}, {places_m[1]}}, 100.0);
    spoil(frame);
    for (int i = 0; i < frames; ++i) {
      const ros::Time stamp(100.0 + i / 15.0);
      FrameMessages messages = frame_messages(frame, camera_.model, stamp);
      spoil_messages(messages);
      bag.write("/eye/color/camera_info", stamp, messages.info);
      bag.write("/" + colour, stamp, messages.colour);
      bag.write("/" + depth_topic("eye"), stamp, messages.depth);
    }
  }

  // What is said where nothing comes of it; no output stays then.
  std::string refusal() const {
    std::string said;
    try {
      replay();
    } catch (const std::runtime_error& error) {
      said = error.what();
    }
    EXPECT_FALSE(fs::exists(path("output.bag")) || fs::exists(path("output.bag.part")));
    return said;
  }
  void expect_refusal(const std::string& words) const {
    const std::string said = refusal();
    EXPECT_NE(said.find(words), std::string::npos) << said;
  }

  const std::vector<Eigen::Vector3d> places_m = {{0, -0.008, -0.03}, {0, -0.008, -0.08}};
  const TrackerCamera camera_ = test::camera_at("eye", {0.1, -0.5, -0.1}, {0, 0, -0.05});
};

TEST_F(BareReplay, CountsHowOftenEachMarkerWasSeen) {
  film();
  const ReplaySummary summary = replay();
  EXPECT_FALSE(summary.repeated);
  EXPECT_EQ(summary.written, frames);
  EXPECT_EQ(summary.seen, (std::map<std::string, long>{{"a", frames}, {"b", frames}}));
  EXPECT_TRUE(summary.notes.empty());
}

TEST_F(BareReplay, SaysWhyNoMarkerWasSeen) {
  film([](RgbdFrame& frame) { frame.depth_m = 0; });
  expect_refusal(
      "none of its 2 markers was seen in 6 times. eye: in its last image 2 things look like a marker, and "
      "its depth image is empty");
  film([](RgbdFrame& frame) { frame.depth_m *= 10.0; });
  expect_refusal("so depth is in another unit, by a factor of 10");
  film([](RgbdFrame& frame) { cv::cvtColor(frame.colour, frame.colour, cv::COLOR_RGB2BGR); });
  expect_refusal("but 2 with red and blue exchanged");
  film([](RgbdFrame& frame) { frame.colour = cv::Scalar(90, 90, 90); });
  expect_refusal("nothing in its image looks like a marker");
}

TEST_F(BareReplay, PairsImagesOfAboutOneTime) {
  const auto later = [](double time_s) {
    return [time_s](FrameMessages& messages) { messages.depth.header.stamp += ros::Duration(time_s); };
  };
  film([](RgbdFrame&) {}, later(0.005));
  const ReplaySummary summary = replay();
  EXPECT_EQ(summary.seen.at("a"), frames);
  EXPECT_EQ(summary.notes, std::vector<std::string>{"eye: colour and depth that are up to 5 ms apart were paired"});
  fs::remove(path("output.bag"));
  film([](RgbdFrame&) {}, later(0.03));
  expect_refusal(
      "eye: 6 colour and 6 depth images, none at the same time: they are 30 ms apart, and at most 16 ms are");
}

TEST_F(BareReplay, NamesWhatDoesNotFit) {
  film([](RgbdFrame&) {}, [](FrameMessages&) {}, "eye/color/image_rect");
  expect_refusal("no images on eye/color/image_raw; images of the recording: /eye/");
  film([](RgbdFrame&) {}, [](FrameMessages& messages) { messages.info.width = 1280; });
  expect_refusal("6 times: a frame of camera 'eye' was left out: images are 848 x 480, not as camera_info says 1280");
  film([](RgbdFrame&) {}, [](FrameMessages& messages) { messages.depth.encoding = "8UC1"; });
  expect_refusal("6 times: depth: encoding '8UC1' is not one of 16UC1, mono16, 32FC1");
  film([](RgbdFrame&) {},
       [](FrameMessages& messages) {
         messages.info.distortion_model = "equidistant";
         messages.info.D = {0.01, 0, 0, 0};
       });
  expect_refusal("distortion_model 'equidistant' with 4 coefficients; allowed: plumb_bob with 5");
  film();
  options_.scene.clear();
  expect_refusal("there is no scene");
}

TEST_F(BareReplay, TakesOtherEncodingsAndLenses) {
  film([](RgbdFrame&) {},
       [](FrameMessages& messages) {
         messages.depth.encoding = "mono16";
         messages.info.distortion_model = "rational_polynomial";
         messages.info.D.assign(8, 0.0);
         messages.info.D[0] = messages.info.D[5] = 0.3;  // which cancel each other
       });
  EXPECT_EQ(replay().seen.at("b"), frames);
}

TEST(PairStamps, TakesTheSameTimeFirstAndNoImageTwice) {
  using Pairs = std::map<double, double>;
  EXPECT_EQ(pair_stamps({1, 2, 3}, {3, 1, 2}, 0.0), (Pairs{{1, 1}, {2, 2}, {3, 3}}));
  EXPECT_EQ(pair_stamps({1, 1.01}, {1.01}, 0.02), (Pairs{{1.01, 1.01}}));
  EXPECT_EQ(pair_stamps({1, 2}, {1.25, 2.25}, 0.5), (Pairs{{1, 1.25}, {2, 2.25}}));
  EXPECT_EQ(pair_stamps({1, 2}, {1.75}, 0.5), (Pairs{{2, 1.75}}));
  EXPECT_TRUE(pair_stamps({1, 2}, {}, 0.5).empty());
}

}  // namespace
}  // namespace soft_robot_lab
