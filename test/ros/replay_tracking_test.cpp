// SPDX-License-Identifier: BSD-3-Clause
// A recording of a session whose recorder lost an image.
#include "ros/replay_tracking.h"

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <std_msgs/String.h>
#include <unistd.h>

#include "ros/conversions.h"
#include "ros/image_messages.h"
#include "ros/topics.h"
#include "ros/tracker_parameters.h"
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

TEST_F(Replay, RefusesTopicsOfOtherTypes) {
  for (const std::string& topic : {std::string(topics::tracker_steps), std::string(topics::tracker_markers),
                                   std::string(topics::simulator_markers), std::string(topics::reality_gap),
                                   colour_topic("eye"), depth_topic("eye")}) {
    record(0.0, true);
    rosbag::Bag(path("session.bag"), rosbag::bagmode::Append).write("/" + topic, ros::Time(100.1), std_msgs::String());
    EXPECT_THROW(replay(), std::runtime_error) << topic;
  }
}

}  // namespace
}  // namespace soft_robot_lab
