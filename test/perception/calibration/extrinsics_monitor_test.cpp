// SPDX-License-Identifier: BSD-3-Clause
#include "perception/calibration/extrinsics_monitor.h"

#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <random>
#include <stdexcept>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "perception/calibration/camera_pose.h"

namespace soft_robot_lab {
namespace {

// A robot of six markers that swings, filmed at 30 Hz by cameras with a D415's noise, some of which move at some time.
class Session {
 public:
  explicit Session(int camera_count = 2) {
    for (int i = 0; i < camera_count; ++i) {
      const std::string name = i == 0 ? "left" : i == 1 ? "right" : "top";
      cameras_.push_back({name, look_at({-0.25 + 0.25 * i, -0.5, -0.3 + 0.2 * i}, {0, 0, -0.05}), {}});
    }
  }

  // The robot is elsewhere than expected from that time on.
  double surprise_s = std::numeric_limits<double>::infinity();
  Eigen::Vector3d surprise_m{0.006, 0, 0.003};

  double now_s() const { return frame_ / 30.0; }
  void knock(std::size_t camera, const Eigen::Isometry3d& motion) { truth_from_calibrated_[camera] = motion; }

  void run(ExtrinsicsMonitor& watch, double until_s) {
    for (; now_s() < until_s; ++frame_) watch.add(now_s(), sights());
  }

  // When the first warning came.
  std::optional<double> run_until_warned(ExtrinsicsMonitor& watch, double until_s) {
    for (; now_s() < until_s; ++frame_) {
      watch.add(now_s(), sights());
      if (!watch.warnings().empty()) return now_s();
    }
    return std::nullopt;
  }

 private:
  std::vector<CameraObservation> sights() {
    std::vector<CameraObservation> all;
    for (std::size_t i = 0; i < cameras_.size(); ++i)
      for (int marker = 0; marker < 6; ++marker) {
        if (hidden_(random_) < 0.2) continue;
        all.push_back(sight(i, marker));
      }
    return all;
  }

  CameraObservation sight(std::size_t camera, int marker) {
    CameraObservation sight{cameras_[camera].name, "marker_" + std::to_string(marker), {}, {}, {}};
    const double depth_m = 0.02 * (marker + 1), swing_m = 0.3 * depth_m * std::sin(2.5 * now_s());
    sight.expected_m = {swing_m + (marker % 2 ? 0.015 : -0.015), -0.02, -depth_m};
    const Eigen::Vector3d true_m =
        now_s() < surprise_s ? sight.expected_m : Eigen::Vector3d(sight.expected_m + surprise_m);
    const Eigen::Isometry3d& pose = cameras_[camera].world_from_camera;
    const Eigen::Vector3d sigma_m(0.0001, 0.0001, 0.0007);
    const Eigen::Vector3d noise_m =
        sigma_m.cwiseProduct(Eigen::Vector3d::NullaryExpr([&] { return normal_(random_); }));
    const Eigen::Isometry3d moved = pose * truth_from_calibrated_[camera];
    sight.measured_m = pose * (moved.inverse() * true_m + noise_m);
    sight.covariance_m2 = pose.linear() * sigma_m.cwiseAbs2().asDiagonal() * pose.linear().transpose();
    return sight;
  }

  std::vector<CameraPose> cameras_;
  std::vector<Eigen::Isometry3d> truth_from_calibrated_{3, Eigen::Isometry3d::Identity()};
  int frame_ = 0;
  std::mt19937 random_{1};
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> hidden_{0, 1};
};

Eigen::Isometry3d shifted(double x_m, double y_m, double z_m) {
  return Eigen::Isometry3d(Eigen::Translation3d(x_m, y_m, z_m));
}

TEST(ExtrinsicsMonitor, NamesACameraThatWasMovedByFiveMillimetres) {
  for (const std::size_t camera : {0u, 1u})
    for (const Eigen::Isometry3d& motion : {shifted(0.005, 0, 0), shifted(0, -0.005, 0), shifted(0, 0, 0.005)}) {
      Session session;
      ExtrinsicsMonitor watch({});
      session.run(watch, 10);
      ASSERT_TRUE(watch.warnings().empty());
      session.knock(camera, motion);
      const auto warned_s = session.run_until_warned(watch, 15);
      ASSERT_TRUE(warned_s);
      session.run(watch, *warned_s + 3);
      ASSERT_EQ(watch.warnings().size(), 1u);
      const CameraWarning& warning = watch.warnings()[0];
      EXPECT_EQ(warning.cameras, std::vector<std::string>{camera == 0 ? "left" : "right"}) << warning.message;
      EXPECT_NEAR(warning.displacement_m, 0.005, 0.0005);
      EXPECT_EQ(warning.message, warning.cameras.front() + " was moved: " + warning.difference + " Calibrate again.");
      EXPECT_EQ(warning.difference.find("left and right see the markers "), 0u) << warning.difference;
    }
}

// As an emulated session's cameras stand: its log had a warning every ten seconds.
TEST(ExtrinsicsMonitor, WarnsOnceOfWhatStaysAtTheThreshold) {
  Session session;
  ExtrinsicsMonitor watch({});
  int warned = 0;
  bool before = false;
  for (int i = 0; i < 16; ++i) {
    session.knock(1, shifted(i % 2 == 0 ? 0.0027 : 0.0023, 0, 0));
    session.run(watch, session.now_s() + 6.0);
    const bool now = !watch.warnings().empty();
    warned += now && !before;
    before = now;
  }
  EXPECT_EQ(warned, 1);
  session.knock(1, shifted(0.001, 0, 0));
  session.run(watch, session.now_s() + 5.0);
  EXPECT_TRUE(watch.warnings().empty()) << "it is over well below";
}

TEST(ExtrinsicsMonitor, NoticesATurn) {
  Session session;
  ExtrinsicsMonitor watch({});
  session.run(watch, 10);
  session.knock(1, Eigen::Isometry3d(Eigen::AngleAxisd(0.5 * M_PI / 180, Eigen::Vector3d::UnitY())));
  EXPECT_TRUE(session.run_until_warned(watch, 15));
}

TEST(ExtrinsicsMonitor, StaysQuietForTenMinutesOfNoiseAndMotion) {
  Session session;
  ExtrinsicsMonitor watch({});
  EXPECT_FALSE(session.run_until_warned(watch, 600));
}

TEST(ExtrinsicsMonitor, DoesNotBlameCamerasForWhatTheRobotDoes) {
  Session session;
  session.surprise_s = 5;
  ExtrinsicsMonitor watch({});
  EXPECT_FALSE(session.run_until_warned(watch, 20));
}

TEST(ExtrinsicsMonitor, NamesBothWhereNothingTellsWhichOneMoved) {
  // From the start, and where the robot hangs is not known either.
  Session session;
  session.surprise_s = 0;
  session.surprise_m = {0.0025, 0, 0};
  session.knock(
      0, Eigen::Isometry3d(Eigen::Translation3d(
             0.005 * (look_at({-0.25, -0.5, -0.3}, {0, 0, -0.05}).linear().transpose() * Eigen::Vector3d::UnitX()))));
  ExtrinsicsMonitor watch({});
  ASSERT_TRUE(session.run_until_warned(watch, 5));
  EXPECT_EQ(watch.warnings()[0].cameras.size(), 2u);
  EXPECT_NE(watch.warnings()[0].message.find("left or right"), std::string::npos);
}

TEST(ExtrinsicsMonitor, BelievesTwoCamerasAgainstOne) {
  Session session(3);
  session.surprise_s = 10;  // what is expected does not help
  ExtrinsicsMonitor watch({});
  session.run(watch, 10);
  session.knock(2, shifted(0, 0.005, 0));
  ASSERT_TRUE(session.run_until_warned(watch, 15));
  session.run(watch, 16);
  ASSERT_EQ(watch.warnings().size(), 2u);
  for (const CameraWarning& warning : watch.warnings())
    EXPECT_EQ(warning.cameras, std::vector<std::string>{"top"}) << warning.message;
}

TEST(ExtrinsicsMonitor, IsSatisfiedByANewCalibrationOrTheCameraBackInPlace) {
  Session session;
  ExtrinsicsMonitor watch({});
  session.run(watch, 3);
  session.knock(0, shifted(0.005, 0, 0));
  ASSERT_TRUE(session.run_until_warned(watch, 8));
  session.knock(0, Eigen::Isometry3d::Identity());
  session.run(watch, session.now_s() + 4);
  EXPECT_TRUE(watch.warnings().empty());
  session.knock(0, shifted(0.005, 0, 0));
  ASSERT_TRUE(session.run_until_warned(watch, 20));
  watch.reset();
  EXPECT_TRUE(watch.warnings().empty());
}

TEST(ExtrinsicsMonitor, LeavesOutWhatIsNotFiniteAndStartsAnewWhenTheClockGoesBack) {
  ExtrinsicsMonitor watch({});
  CameraObservation left{"left", "tip", {0, 0, 0}, 1e-6 * Eigen::Matrix3d::Identity(), {0, 0, 0}}, right = left;
  right.camera = "right";
  right.measured_m.x() = 0.01;
  CameraObservation broken = right;
  broken.measured_m.x() = std::numeric_limits<double>::quiet_NaN();
  for (int i = 0; i < 300; ++i) watch.add(10 + i / 30.0, {left, broken});
  EXPECT_TRUE(watch.warnings().empty());
  for (int i = 300; i < 600; ++i) watch.add(10 + i / 30.0, {left, right});
  EXPECT_EQ(watch.warnings().size(), 1u);
  watch.add(1, {left, right});
  EXPECT_TRUE(watch.warnings().empty());
}

TEST(ExtrinsicsMonitor, RefusesWrongSettings) {
  const std::function<void(ExtrinsicsMonitorSettings&)> spoil[] = {
      [](ExtrinsicsMonitorSettings& settings) { settings.window_s = 0; },
      [](ExtrinsicsMonitorSettings& settings) { settings.check_period_s = -1; },
      [](ExtrinsicsMonitorSettings& settings) { settings.threshold_m = std::nan(""); },
      [](ExtrinsicsMonitorSettings& settings) { settings.confirm_s = -1; },
      [](ExtrinsicsMonitorSettings& settings) { settings.min_sights = 5; },
  };
  for (const auto& wrong : spoil) {
    ExtrinsicsMonitorSettings settings;
    wrong(settings);
    EXPECT_THROW(ExtrinsicsMonitor{settings}, std::invalid_argument);
  }
}

}  // namespace
}  // namespace soft_robot_lab
