// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/perception/tracking/tracker.h"

#include <limits>
#include <stdexcept>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "perception/tracking/annotate.h"
#include "drawn_scene.h"

namespace soft_robot_lab {
namespace {

using namespace test;

constexpr double kFrame_s = 1 / 30.0;

// Four blue markers in a line, filmed by two cameras.
class TrackerOfALine : public testing::Test {
 protected:
  TrackerOfALine() {
    for (int i = 0; i < 4; ++i) {
      DrawnMarker marker;
      marker.position_m = {0, -0.012, -0.02 - 0.016 * i};
      scene_.push_back(marker);
      markers_.push_back({"m" + std::to_string(i), marker.position_m});
    }
    settings_.detector.colours = {{"blue", {{200, 260, 0.45, 1, 0.12, 1}}}, {"red", {{340, 20, 0.5, 1, 0.2, 1}}}};
  }
  Tracker tracker() const {
    Tracker tracker(settings_, markers_);
    tracker.set_camera(left_);
    tracker.set_camera(right_);
    return tracker;
  }
  std::vector<RgbdFrame> film_both(double time_s) const {
    return {film(left_, scene_, time_s), film(right_, scene_, time_s)};
  }
  void expect_seen(const TrackerReport& report, double tolerance_m, int cameras = 2) const {
    ASSERT_EQ(report.markers.size(), scene_.size());
    for (std::size_t i = 0; i < scene_.size(); ++i) {
      EXPECT_EQ(report.markers[i].source, MarkerSource::seen) << i;
      EXPECT_EQ(report.markers[i].cameras, cameras) << i;
      EXPECT_LT((report.markers[i].position_m - scene_[i].position_m).norm(), tolerance_m) << i;
    }
  }
  void move(const Eigen::Vector3d& step_m) {
    for (DrawnMarker& marker : scene_) marker.position_m += step_m;
  }
  TrackerCamera left_ = camera_at("left", {-0.3, -0.52, 0.05}, {0, 0, -0.05});
  TrackerCamera right_ = camera_at("right", {0.3, -0.52, 0.05}, {0, 0, -0.05});
  std::vector<DrawnMarker> scene_;
  std::vector<TrackedMarker> markers_;
  TrackerSettings settings_;
};

TEST_F(TrackerOfALine, FindsMarkersWithinATenthOfAMillimetreFromTheFirstFrameOn) {
  Tracker tracker = this->tracker();
  move({0.004, 0.002, -0.003});
  for (int frame = 0; frame < 6; ++frame) {
    expect_seen(tracker.update(film_both(frame * kFrame_s)), 1e-4);
    move({0.002, 0.0005, 0.001});
  }
}

TEST_F(TrackerOfALine, GoesOnWithTheOtherCameraAndSaysWhatIsWrong) {
  Tracker tracker = this->tracker();
  tracker.update(film_both(0));
  std::vector<RgbdFrame> frames = film_both(1 * kFrame_s);
  frames[1].depth_m = frames[1].depth_m(cv::Rect(0, 0, 424, 480)).clone();
  TrackerReport report = tracker.update(frames);
  expect_seen(report, 5e-4, 1);
  ASSERT_EQ(report.problems.size(), 1u);
  EXPECT_NE(report.problems[0].message.find("424 x 480"), std::string::npos) << report.problems[0].message;
  EXPECT_FALSE(report.problems[0].silent);
  for (int frame = 2; frame < 20; ++frame) report = tracker.update({film(left_, scene_, frame * kFrame_s)});
  expect_seen(report, 5e-4, 1);
  ASSERT_EQ(report.problems.size(), 1u);
  EXPECT_NE(report.problems[0].message.find("right"), std::string::npos) << report.problems[0].message;
  EXPECT_TRUE(report.problems[0].silent);
}

// As where a session starts: one camera's first frame comes seconds after the other's.
TEST_F(TrackerOfALine, AwaitsTheFirstFrameOfACamera) {
  Tracker tracker = this->tracker();
  for (int frame = 0; frame < 40; ++frame)
    EXPECT_TRUE(tracker.update({film(left_, scene_, frame * kFrame_s)}).problems.empty());
  expect_seen(tracker.update(film_both(40 * kFrame_s)), 1e-4);
}

TEST_F(TrackerOfALine, LeavesOutFramesThatCannotBeUsed) {
  Tracker tracker = this->tracker();
  tracker.update(film_both(0));
  const RgbdFrame good = film(left_, scene_, kFrame_s);
  std::vector<RgbdFrame> bad(6, good);
  bad[0].camera = "somebody";
  bad[1].stamp_s = std::numeric_limits<double>::quiet_NaN();
  bad[2].colour = cv::Mat();
  bad[3].depth_m = cv::Mat::zeros(480, 848, CV_16U);
  bad[4].colour = plain_image(640, 480, kDark);
  bad[4].depth_m = cv::Mat::zeros(480, 640, CV_32F);
  bad[5].stamp_s = -1;
  for (const RgbdFrame& frame : bad) {
    const TrackerReport report = tracker.update({frame});
    EXPECT_EQ(report.problems.size(), 1u);
    EXPECT_EQ(report.stamp_s, 0);
    EXPECT_FALSE(report.updated);
    EXPECT_TRUE(report.sights.empty());
  }
  EXPECT_EQ(tracker.update({}).late_frames, 1);
  expect_seen(tracker.update({good}), 5e-4, 1);
}

// Three frames a second, cameras that contradict each other by 2 mm, and one marker hidden every other time: the motion
// model alone would believe in any exchange.
TEST_F(TrackerOfALine, KeepsNamesOverLongGapsWhereASimulationTellsThePlaces) {
  Tracker tracker = this->tracker();
  tracker.set_simulated({scene_[0].position_m, scene_[1].position_m, scene_[2].position_m, scene_[3].position_m});
  move({0.001, 0.001, -0.003});
  TrackerCamera seen_left = left_, seen_right = right_;
  seen_left.world_from_camera.translation() += Eigen::Vector3d(0.0015, -0.001, 0.001);
  seen_right.world_from_camera.translation() += Eigen::Vector3d(-0.0012, 0.0012, -0.001);
  for (int frame = 0; frame < 25; ++frame) {
    std::vector<DrawnMarker> shown = scene_;
    if (frame % 2 == 1) shown[(frame / 2) % 4].colour = kSkin;
    for (DrawnMarker& marker : shown) marker.position_m.y() += frame % 3 == 0 ? 0.001 : -0.001;
    const TrackerReport report =
        tracker.update({film(seen_left, shown, frame * 0.35), film(seen_right, shown, frame * 0.35)});
    ASSERT_EQ(report.markers.size(), scene_.size());
    for (std::size_t i = 0; i < scene_.size(); ++i) {
      EXPECT_LT((report.markers[i].position_m - shown[i].position_m).norm(), 0.006) << frame << ", " << i;
    }
  }
}

// For the watch over displaced cameras, also where such a camera is too far off for the tracker to believe it.
TEST_F(TrackerOfALine, TellsWhatEachCameraMeasuresAlone) {
  for (const double knock_m : {0.0, 0.005, 0.015}) {
    Tracker tracker = this->tracker();
    for (int frame = 0; frame < 5; ++frame) tracker.update(film_both(frame * kFrame_s));
    TrackerCamera displaced = right_;
    displaced.world_from_camera.translation().x() += knock_m;
    TrackerReport report;
    for (int frame = 5; frame < 10; ++frame)
      report = tracker.update({film(left_, scene_, frame * kFrame_s), film(displaced, scene_, frame * kFrame_s)});
    EXPECT_TRUE(report.updated);
    ASSERT_EQ(report.sights.size(), 8u) << knock_m;
    for (std::size_t i = 0; i < 8; ++i) {
      const CameraObservation& sight = report.sights[i];
      EXPECT_EQ(sight.camera, i < 4 ? "left" : "right");
      EXPECT_EQ(sight.marker, markers_[i % 4].name);
      EXPECT_EQ(sight.expected_m, markers_[i % 4].rest_position_m);
      const Eigen::Vector3d seen_m = scene_[i % 4].position_m - Eigen::Vector3d(i < 4 ? 0 : knock_m, 0, 0);
      EXPECT_LT((sight.measured_m - seen_m).norm(), 0.001) << knock_m;
    }
  }
}

// One marker is hidden, so that all that is remembered of it counts.
TEST_F(TrackerOfALine, GoesOnFromAStateAsTheTrackerThatToldIt) {
  Tracker first = this->tracker(), second = this->tracker();
  int frame = 0;
  for (; frame < 3; ++frame) first.update(film_both(frame * kFrame_s));
  scene_.erase(scene_.begin() + 1);
  for (; frame < 6; ++frame) {
    move({0.0015, 0, 0});
    first.set_simulated(
        {markers_[0].rest_position_m, {0.01 * frame, 0, 0}, markers_[2].rest_position_m, markers_[3].rest_position_m});
    first.update(film_both(frame * kFrame_s));
  }
  second.update(film_both(1000));  // of which nothing stays
  second.set_state(first.state());
  for (; frame < 10; ++frame) {
    move({0.0015, 0, 0});
    EXPECT_EQ(second.state(), first.state());
    const TrackerReport one = first.update(film_both(frame * kFrame_s));
    const TrackerReport other = second.update(film_both(frame * kFrame_s));
    ASSERT_EQ(one.markers.size(), 4u);
    ASSERT_EQ(other.markers.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(one.markers[i].position_m, other.markers[i].position_m) << frame << ", " << i;
      EXPECT_EQ(one.markers[i].covariance_m2, other.markers[i].covariance_m2) << frame << ", " << i;
      EXPECT_EQ(one.markers[i].source, other.markers[i].source) << frame << ", " << i;
    }
  }
}

TEST_F(TrackerOfALine, RefusesAStateThatIsNone) {
  Tracker tracker = this->tracker();
  std::vector<double> state = tracker.state();
  state.pop_back();
  EXPECT_THROW(tracker.set_state(state), std::invalid_argument);
  state.push_back(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THROW(tracker.set_state(state), std::invalid_argument);
  expect_seen(tracker.update(film_both(0)), 1e-4);
}

TEST_F(TrackerOfALine, FindsMarkersWithoutAnyDepthAsLongAsBothCamerasSeeThem) {
  Tracker tracker = this->tracker();
  for (int frame = 0; frame < 3; ++frame) {
    std::vector<RgbdFrame> frames = film_both(frame * kFrame_s);
    for (RgbdFrame& each : frames) each.depth_m = 0;
    expect_seen(tracker.update(frames), 1e-4);
  }
}

TEST_F(TrackerOfALine, InterpolatesAHiddenMarkerWithGrowingCovarianceAndReportsItLost) {
  settings_.motion.lost_after_s = 0.5;
  Tracker tracker = this->tracker();
  int frame = 0;
  for (; frame < 3; ++frame) tracker.update(film_both(frame * kFrame_s));
  DrawnMarker hidden = scene_[1];
  scene_.erase(scene_.begin() + 1);
  double last_variance_m2 = 0;
  for (; frame < 17; ++frame) {
    move({0.0015, 0, 0});
    hidden.position_m += Eigen::Vector3d(0.0015, 0, 0);
    const TrackerReport report = tracker.update(film_both(frame * kFrame_s));
    ASSERT_EQ(report.markers.size(), 4u);
    EXPECT_EQ(report.markers[1].source, MarkerSource::interpolated);
    EXPECT_EQ(report.markers[2].source, MarkerSource::seen);
    EXPECT_LT((report.markers[1].position_m - hidden.position_m).norm(), 1e-3);
    EXPECT_GT(report.markers[1].covariance_m2.trace(), last_variance_m2);
    last_variance_m2 = report.markers[1].covariance_m2.trace();
  }
  for (; frame < 21; ++frame) tracker.update(film_both(frame * kFrame_s));
  const TrackerReport report = tracker.update(film_both(frame++ * kFrame_s));
  EXPECT_EQ(report.lost, std::vector<std::string>{"m1"});
  EXPECT_EQ(report.markers.size(), 3u);
  scene_.insert(scene_.begin() + 1, hidden);
  expect_seen(tracker.update(film_both(frame * kFrame_s)), 1e-4);
}

TEST_F(TrackerOfALine, ReportsAllAsLostBeforeItHasSeenAny) {
  Tracker tracker = this->tracker();
  scene_.clear();
  const TrackerReport report = tracker.update(film_both(0));
  EXPECT_EQ(report.lost.size(), 4u);
  EXPECT_TRUE(report.markers.empty());
}

// Two markers pass each other, in one camera's image right before one another, where the nearer hides the farther.
TEST_F(TrackerOfALine, KeepsIdentitiesWhereMarkersCross) {
  scene_.resize(3);
  markers_.resize(3);
  scene_[1].position_m = {-0.03, -0.012, -0.03};
  scene_[2].position_m = {0.03, -0.03, -0.03};
  for (DrawnMarker& marker : scene_) marker.skin_radius_m = 0.004;
  for (int i = 0; i < 3; ++i) markers_[i].rest_position_m = scene_[i].position_m;
  settings_.motion.max_stretch = 5;
  Tracker tracker = this->tracker();
  TrackerReport report;
  int interpolated = 0;
  for (int frame = 0; frame < 40; ++frame) {
    report = tracker.update(film_both(frame * kFrame_s));
    ASSERT_EQ(report.markers.size(), 3u);
    for (int i = 0; i < 3; ++i) {
      const bool seen = report.markers[i].source == MarkerSource::seen;
      interpolated += !seen;
      EXPECT_LT((report.markers[i].position_m - scene_[i].position_m).norm(), 2e-3) << i << " at frame " << frame;
    }
    scene_[1].position_m.x() += 0.0015;
    scene_[2].position_m.x() -= 0.0015;
  }
  EXPECT_LT(interpolated, 12);
  expect_seen(report, 10, 2);
}

TEST_F(TrackerOfALine, LooksWhereASimulationHasTheMarkers) {
  move({0.05, 0, 0.02});
  Tracker tracker = this->tracker();
  EXPECT_EQ(tracker.update(film_both(0)).lost.size(), 4u);
  std::vector<Eigen::Vector3d> simulated_m;
  for (const DrawnMarker& marker : scene_)
    simulated_m.push_back(marker.position_m + Eigen::Vector3d(0.003, 0.002, -0.002));
  tracker.set_simulated(simulated_m);
  expect_seen(tracker.update(film_both(kFrame_s)), 1e-4);
  simulated_m.pop_back();
  EXPECT_THROW(tracker.set_simulated(simulated_m), std::invalid_argument);
}

TEST_F(TrackerOfALine, StartsAgainAfterAResetWithAnOlderClock) {
  Tracker tracker = this->tracker();
  expect_seen(tracker.update(film_both(100)), 1e-4);
  EXPECT_EQ(tracker.update(film_both(1)).problems.size(), 2u);
  tracker.reset();
  expect_seen(tracker.update(film_both(1)), 1e-4);
}

TEST_F(TrackerOfALine, IsTheSameAfterFramesWereDropped) {
  Tracker tracker = this->tracker();
  tracker.update(film_both(0));
  tracker.update(film_both(kFrame_s));
  move({0.004, 0, 0});
  expect_seen(tracker.update(film_both(6 * kFrame_s)), 1e-4);
}

TEST_F(TrackerOfALine, DrawsWhatItKnowsIntoTheImage) {
  Tracker tracker = this->tracker();
  tracker.update(film_both(0));
  scene_.pop_back();
  const RgbdFrame frame = film(left_, scene_, kFrame_s);
  const TrackerReport report = tracker.update({frame});
  const cv::Mat image = annotate(frame, left_, report, settings_.marker_radius_m);
  const auto differs = [&](const MarkerObservation& marker) {
    const Eigen::Vector2d pixel = left_.model.project(left_.world_from_camera.inverse() * marker.position_m);
    const cv::Rect around(static_cast<int>(pixel.x()) - 20, static_cast<int>(pixel.y()) - 20, 40, 40);
    return cv::norm(image(around), frame.colour(around), cv::NORM_INF) > 0;
  };
  for (const MarkerObservation& marker : report.markers) EXPECT_TRUE(differs(marker)) << marker.name;
}

TEST_F(TrackerOfALine, RefusesWhatItCannotTrack) {
  EXPECT_THROW(Tracker(settings_, {}), std::invalid_argument);
  EXPECT_THROW(Tracker(settings_, {markers_[0], markers_[0]}), std::invalid_argument);
  auto wrong = markers_;
  wrong[1].rest_position_m.y() = std::numeric_limits<double>::infinity();
  EXPECT_THROW(Tracker(settings_, wrong), std::invalid_argument);
  settings_.marker_colours = {{"nose", "red"}};
  EXPECT_THROW(Tracker(settings_, markers_), std::invalid_argument);
  settings_.marker_colours = {{"m1", "green"}};
  EXPECT_THROW(Tracker(settings_, markers_), std::invalid_argument);
  settings_.marker_colours.clear();
  TrackerCamera bent = left_;
  bent.world_from_camera.linear() *= 1.1;
  EXPECT_THROW(tracker().set_camera(bent), std::invalid_argument);
  bent = left_;
  bent.model.width_px = 0;
  EXPECT_THROW(tracker().set_camera(bent), std::invalid_argument);
}

}  // namespace
}  // namespace soft_robot_lab
