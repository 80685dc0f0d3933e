// SPDX-License-Identifier: BSD-3-Clause
#include "perception/calibration/calibration.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>

#include <gtest/gtest.h>
#include <unistd.h>

#include "ball_scene.h"

namespace soft_robot_lab {
namespace {

constexpr double tolerance_m = 0.004;
const std::string config = SOFT_ROBOT_LAB_SOURCE "/config/";

double turn_deg(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle() * 180 / M_PI;
}

double shift_m(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return (a.translation() - b.translation()).norm();
}

BallPlacement five_balls() { return read_ball_placement(config + "robots/spinebot/balls.yaml"); }

BallPlacement placement_of(const std::vector<Eigen::Vector3d>& positions_m) {
  BallPlacement placement;
  for (const Eigen::Vector3d& position_m : positions_m)
    placement.balls.push_back({"ball_" + std::to_string(placement.balls.size()), position_m});
  return placement;
}

CameraPose some_pose(const std::string& name, double x_m) { return {name, look_at({x_m, -0.5, -0.3}, {0, 0, 0}), {}}; }

// What a camera would find, with D415-like errors; balls come in another order than they were placed in.
BallView view_of(const BallPlacement& placement, const CameraPose& pose, std::uint32_t seed,
                 const std::string& hidden = "") {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  BallView view{pose.name, {}};
  for (auto ball = placement.balls.rbegin(); ball != placement.balls.rend(); ++ball) {
    if (ball->name == hidden) continue;
    FoundBall found;
    const Eigen::Vector3d sigma_m(0.00003, 0.00003, 0.0002);
    found.covariance_m2 = sigma_m.cwiseAbs2().asDiagonal();
    found.center_m = pose.world_from_camera.inverse() * ball->position_m +
                     sigma_m.cwiseProduct(Eigen::Vector3d::NullaryExpr([&] { return normal(random); }));
    view.balls.push_back(found);
  }
  return view;
}

std::string refusal(const std::function<void()>& calibrate) {
  try {
    calibrate();
  } catch (const CalibrationError& error) {
    return error.what();
  }
  return "not refused";
}

void expect_refused(const std::function<void()>& calibrate, const std::string& reason) {
  const std::string message = refusal(calibrate);
  EXPECT_NE(message.find(reason), std::string::npos) << message;
}

// Both cameras of the box, filming the balls of the configuration as D415s would.
class FilmedBalls : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    rig = new CameraSetup(read_camera_setup(config + "cameras/box.yaml"));
    views = new std::vector<BallView>;
    std::vector<Ball> balls;
    for (const PlacedBall& placed : five_balls().balls)
      balls.push_back(ball_at(placed.position_m.x(), placed.position_m.y(), placed.position_m.z()));
    for (const RigCamera& camera : rig->cameras) {
      const BallPictures pictures = film_balls(camera, rig->surroundings, balls, 5);
      const BallSearch search = find_balls(pictures.without, pictures.with, camera.model, {});
      EXPECT_TRUE(search.rejected.empty());
      views->push_back({camera.pose.name, search.balls});
    }
  }
  static void TearDownTestSuite() {
    delete rig;
    delete views;
  }
  static CameraSetup* rig;
  static std::vector<BallView>* views;
};
CameraSetup* FilmedBalls::rig = nullptr;
std::vector<BallView>* FilmedBalls::views = nullptr;

TEST_F(FilmedBalls, TellWhereTheCamerasStand) {
  std::vector<CameraPose> found;
  for (std::size_t i = 0; i < views->size(); ++i) {
    const CameraCalibration calibration = calibrate_by_balls((*views)[i], five_balls());
    const Eigen::Isometry3d& truth = rig->cameras[i].pose.world_from_camera;
    EXPECT_LT(turn_deg(calibration.pose.world_from_camera, truth), 0.05);
    EXPECT_LT(shift_m(calibration.pose.world_from_camera, truth), 0.0004);
    EXPECT_EQ(calibration.seen.size(), 5u);
    EXPECT_LT(*calibration.pose.residual_m, 0.0005);
    found.push_back(calibration.pose);
  }
  const std::string path =
      (std::filesystem::temp_directory_path() / ("calibration_" + std::to_string(getpid()) + ".yaml")).string();
  write_camera_poses(path, found);
  const std::vector<CameraPose> read = read_camera_poses(path);
  std::filesystem::remove(path);
  ASSERT_EQ(read.size(), 2u);
  EXPECT_TRUE(read[1].world_from_camera.isApprox(found[1].world_from_camera, 1e-14));
  EXPECT_EQ(read[1].residual_m, found[1].residual_m);
}

TEST_F(FilmedBalls, TellOneCameraFromTheOther) {
  const CameraPose& known = rig->cameras[0].pose;
  const CameraCalibration calibration = calibrate_by_camera((*views)[1], (*views)[0], known, tolerance_m);
  EXPECT_EQ(calibration.pose.name, "camera_right");
  EXPECT_LT(turn_deg(calibration.pose.world_from_camera, rig->cameras[1].pose.world_from_camera), 0.1);
  EXPECT_LT(shift_m(calibration.pose.world_from_camera, rig->cameras[1].pose.world_from_camera), 0.0005);
}

TEST(Calibration, DoesWithoutABallThatOneCameraDoesNotSee) {
  BallPlacement placement = five_balls();
  placement.balls.push_back({"sixth", {0.03, -0.09, 0.07}});
  const CameraPose pose = some_pose("left", -0.2), other = some_pose("right", 0.2);
  const BallView view = view_of(placement, pose, 1, "middle"), all = view_of(placement, other, 2);
  const CameraCalibration by_balls = calibrate_by_balls(view, placement);
  const CameraCalibration by_camera = calibrate_by_camera(view, all, other, tolerance_m);
  for (const CameraCalibration& calibration : {by_balls, by_camera}) {
    EXPECT_EQ(calibration.seen.size(), 5u);
    EXPECT_LT(turn_deg(calibration.pose.world_from_camera, pose.world_from_camera), 0.1);
    EXPECT_LT(shift_m(calibration.pose.world_from_camera, pose.world_from_camera), 0.001);
  }
  EXPECT_EQ(by_balls.seen[0], "sixth");
}

TEST(Calibration, RefusesFewerThanFiveBalls) {
  const BallPlacement placement = five_balls();
  const CameraPose pose = some_pose("left", -0.2), other = some_pose("right", 0.2);
  const BallView four = view_of(placement, pose, 1, "middle"), five = view_of(placement, other, 2);
  expect_refused([&] { calibrate_by_balls(four, placement); }, "left sees 4 balls; allowed: 5 or more");
  expect_refused([&] { calibrate_by_camera(four, five, other, tolerance_m); }, "left sees 4 balls");
  expect_refused([&] { calibrate_by_camera(five, four, pose, tolerance_m); }, "left sees 4 balls");
  expect_refused([&] { require_unambiguous(placement_of({{0, 0, 0}, {0, 0, 1}, {0, 1, 0}, {1, 0, 0}})); }, "5 or more");
}

TEST(Calibration, RefusesSymmetricPlacements) {
  const std::vector<BallPlacement> symmetric{
      placement_of({{0.1, 0, 0}, {0, 0.1, 0}, {-0.1, 0, 0}, {0, -0.1, 0}, {0, 0, 0.12}}),            // a pyramid
      placement_of({{0, -0.15, 0}, {0, 0.12, 0}, {0.08, 0.03, 0}, {-0.08, 0.03, 0}, {0, 0.02, 0}}),  // a flat kite
      placement_of({{0, 0, 0}, {0.05, 0, 0}, {0.1, 0, 0}, {0.15, 0, 0}, {0.2, 0, 0}})};              // a row
  const CameraPose pose = some_pose("left", -0.2), other = some_pose("right", 0.2);
  for (const BallPlacement& placement : symmetric) {
    expect_refused([&] { require_unambiguous(placement); }, "placed ambiguously");
    const BallView view = view_of(placement, pose, 1);
    expect_refused([&] { calibrate_by_balls(view, placement); }, "placed ambiguously");
    expect_refused([&] { calibrate_by_camera(view, view_of(placement, other, 2), other, tolerance_m); },
                   "placed ambiguously");
  }
  const std::string message = refusal([&] { require_unambiguous(symmetric[1]); });
  EXPECT_NE(message.find("(ball_0, ball_1, ball_2, ball_3, ball_4)"), std::string::npos) << message;
  EXPECT_NE(message.find("(ball_0, ball_1, ball_3, ball_2, ball_4)"), std::string::npos) << message;
  EXPECT_NE(message.find("move one of ball_2, ball_3 by more than"), std::string::npos) << message;
}

TEST(Calibration, RefusesBallsOnALine) {
  const BallPlacement row = placement_of({{0, 0, 0}, {0.03, 0, 0}, {0.09, 0, 0}, {0.15, 0, 0}, {0.25, 0, 0}});
  expect_refused([&] { require_unambiguous(row); }, "on a line");
}

TEST(Calibration, TakesWhatOnlyAMirrorWouldConfuse) {
  const BallPlacement mirrored = placement_of({{0.1, 0, 0.03},
                                               {-0.05, 0.12, 0.07},
                                               {0.02, -0.08, 0.11},
                                               {0.1, 0, -0.03},
                                               {-0.05, 0.12, -0.07},
                                               {0.02, -0.08, -0.11}});
  EXPECT_NO_THROW(require_unambiguous(mirrored));
  const CameraPose pose = some_pose("left", -0.2);
  EXPECT_LT(
      turn_deg(calibrate_by_balls(view_of(mirrored, pose, 1), mirrored).pose.world_from_camera, pose.world_from_camera),
      0.1);
}

TEST(Calibration, RefusesBallsThatAreNotWhereTheyShouldBe) {
  BallPlacement placement = five_balls();
  const BallView view = view_of(placement, some_pose("left", -0.2), 1);
  placement.balls[2].position_m.x() += 0.03;
  expect_refused([&] { calibrate_by_balls(view, placement); }, "do not fit");
}

std::vector<CalibrationMarker> markers_seen_from(const CameraPose& pose) {
  std::vector<CalibrationMarker> markers;
  for (const Eigen::Vector3d& expected_m :
       {Eigen::Vector3d(0.02, -0.02, -0.02), {-0.02, -0.02, -0.03}, {0, -0.03, -0.06}, {0.02, 0.01, -0.1}}) {
    CalibrationMarker marker;
    marker.name = "marker_" + std::to_string(markers.size());
    marker.expected_m = expected_m;
    marker.in_camera_m = pose.world_from_camera.inverse() * expected_m;
    marker.covariance_m2 = Eigen::Vector3d(1e-8, 1e-8, 1e-6).asDiagonal();
    markers.push_back(marker);
  }
  return markers;
}

TEST(Calibration, FindsACameraByTheRobotsMarkers) {
  const CameraPose pose = some_pose("left", -0.2);
  std::vector<CalibrationMarker> markers = markers_seen_from(pose);
  const CameraCalibration calibration = calibrate_by_markers("left", markers, 0.002);
  EXPECT_TRUE(calibration.pose.world_from_camera.isApprox(pose.world_from_camera, 1e-9));
  EXPECT_EQ(calibration.seen.back(), "marker_3");
  markers[3].expected_m.z() -= 0.02;
  expect_refused([&] { calibrate_by_markers("left", markers, 0.002); }, "where it is expected");
  markers.pop_back();
  expect_refused([&] { calibrate_by_markers("left", markers, 0.002); }, "left sees 3 markers; allowed: 4 or more");
}

TEST(BallPlacement, IsReadStrictly) {
  EXPECT_EQ(five_balls().balls.size(), 5u);
  const std::string good =
      "balls: [{name: a, position_m: [0, 0, 0]}, {name: b, position_m: [0.1, 0, 0]}, {name: c, position_m: [0, 0.13, "
      "0]},"
      " {name: d, position_m: [0.03, 0.02, 0.2]}, {name: e, position_m: [-0.07, 0.05, 0.09]}]\n";
  const std::string path =
      (std::filesystem::temp_directory_path() / ("balls_" + std::to_string(getpid()) + ".yaml")).string();
  const auto read = [&](const std::string& text) {
    std::ofstream(path) << text;
    return read_ball_placement(path);
  };
  EXPECT_NO_THROW(read(good));
  EXPECT_THROW(read(good + "radius_m: 0"), SettingsError);
  EXPECT_THROW(read(good + "tolerance_m: -1"), SettingsError);
  EXPECT_THROW(read(good + "colour: white"), SettingsError);
  EXPECT_THROW(read("balls: [{name: a, position_m: [0, 0, 0]}]"), SettingsError);
  std::string twice = good;
  twice.replace(twice.find("name: b"), 7, "name: a");
  EXPECT_THROW(read(twice), SettingsError);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace soft_robot_lab
