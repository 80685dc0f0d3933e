// SPDX-License-Identifier: BSD-3-Clause
// The files of each robot of record belong together: one command for robot and rig, stickers and balls that the box's
// cameras see, and the source's tables.
#include <filesystem>

#include <gtest/gtest.h>

#include "study/rig/gap_settings.h"
#include "robot/scene/scene_files.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "session/report/frame_recorder.h"
#include "study/rig/emulated_lab.h"
#include "hardware/plant/same_commands.h"
#include "perception/calibration/calibration_session.h"
#include "soft_robot_lab/perception/tracking/tracker.h"
#include "settings/overrides_from.h"

namespace soft_robot_lab {
namespace {

const std::string kConfig = SOFT_ROBOT_LAB_SOURCE "/config/";
const std::vector<std::string> kRobots = {"spinebot",  "hammerbot", "bubblebot",   "bubblefinger",  "finger_a1",
                                          "finger_a2", "gripper",   "hanging_bar", "hollow_cuboid", "fibre_arm"};
const std::vector<std::string> kRobotsOnRigs = {"spinebot",  "hammerbot", "bubblebot", "bubblefinger",
                                                "finger_a1", "finger_a2", "gripper",   "fibre_arm"};

// Of motors, or of pressure channels.
std::string rig_of(const std::string& robot) {
  return kConfig + "robots/" + robot + (robot == "fibre_arm" ? "/pressures.yaml" : "/motors.yaml");
}

std::unique_ptr<Simulation> load(const std::string& robot, const std::string& overrides = "") {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  options.overrides = overrides_from(overrides);
  return load_scene(kConfig + "robots/" + robot + "/robot.yaml", options).simulation;
}

std::string refusal(const Simulation& simulation, const RigSettings& rig) {
  try {
    require_same_commands(simulation, "robot.yaml", rig, "rig.yaml");
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(RobotFiles, OneCommandMeansTheSameToRobotAndRig) {
  for (const std::string& robot : kRobotsOnRigs) EXPECT_EQ(refusal(*load(robot), load_rig(rig_of(robot))), "") << robot;
}

TEST(RobotFiles, CommandsThatMeanTwoThingsAreRefusedWithBothFiles) {
  const RigSettings syringe = load_rig(kConfig + "robots/bubblefinger/motors.yaml");
  EXPECT_EQ(refusal(*load("bubblefinger", "chambers: {main: {command: beta}}"), syringe),
            "robot.yaml takes the command of 'main' as the amount of gas, beta [1], rig.yaml as the plunger's travel "
            "[ml]: one command goes to both, so they must agree");
  EXPECT_EQ(refusal(*load("bubblefinger", "chambers: {main: {command: volume_offset}}"), syringe), "");
  const RigSettings cable = parse_rig(
      "{device: /dev/rig, motors: [{name: main, cable: {rest_length_m: 0.1, min_contraction: 0.5, max_contraction: "
      "1.1}}]}",
      "rig.yaml");
  EXPECT_NE(refusal(*load("bubblefinger"), cable).find("contraction of a cable [1]"), std::string::npos);
  EXPECT_EQ(refusal(*load("spinebot"), syringe), "rig.yaml has no motor for 'left' of robot.yaml");
}

// What the box's cameras see of each robot as it hangs, by exact sensors.
class SeenRobotOfRecord : public testing::TestWithParam<std::string> {
 protected:
  SeenRobotOfRecord() : simulation_(load(GetParam())), cameras_(read_camera_setup(kConfig + "cameras/box.yaml")) {
    simulation_->solve_equilibrium();
  }

  Capture take(const CameraSetup& cameras) const {
    FrameRecorderOptions exact;
    exact.sensor = SensorModel{};
    return FrameRecorder(*simulation_, cameras, exact).take(simulation_->state(), simulation_->state(), 0.0);
  }

  std::unique_ptr<Simulation> simulation_;
  CameraSetup cameras_;
};

TEST_P(SeenRobotOfRecord, HasStickersThatItsTrackerFinds) {
  Tracker tracker(load_tracker(kConfig + "robots/" + GetParam() + "/tracker.yaml"), [&] {
    std::vector<TrackedMarker> markers;
    for (const Marker& marker : simulation_->markers()) markers.push_back({marker.name(), marker.rest_position_m()});
    return markers;
  }());
  for (const RigCamera& camera : cameras_.cameras)
    tracker.set_camera({camera.pose.name, camera.model, camera.pose.world_from_camera});
  const Capture shot = take(cameras_);
  std::vector<Eigen::Vector3d> expected;
  for (Eigen::Index i = 0; i < shot.markers_m.cols(); ++i) expected.push_back(shot.markers_m.col(i));
  tracker.set_simulated(expected);
  const TrackerReport result = tracker.update(shot.frames);
  for (std::size_t i = 0; i < result.markers.size(); ++i) {
    EXPECT_EQ(result.markers[i].source, MarkerSource::seen) << result.markers[i].name;
    EXPECT_LT((result.markers[i].position_m - expected[i]).norm(), 0.001) << result.markers[i].name;
  }
}

TEST_P(SeenRobotOfRecord, LeavesTheBallsThatItIsCalibratedByInSight) {
  const BallPlacement placement = read_ball_placement(kConfig + "robots/" + GetParam() + "/balls.yaml");
  CalibrationSession calibration(placement, {}, 1);
  for (const RigCamera& camera : cameras_.cameras)
    calibration.set_camera({camera.pose.name, camera.model, camera.pose.world_from_camera});
  for (const RgbdFrame& frame : take(cameras_).frames) calibration.add(frame);
  calibration.remember_without_balls();
  CameraSetup with_balls = cameras_;
  for (const PlacedBall& ball : placement.balls)
    with_balls.surroundings.balls.push_back({ball.position_m, placement.radius_m, {0.9, 0.9, 0.9}});
  for (const RgbdFrame& frame : take(with_balls).frames) calibration.add(frame);
  for (const CameraCalibration& found : calibration.calibrate()) {
    EXPECT_EQ(found.seen.size(), placement.balls.size()) << found.pose.name;
    for (const RigCamera& camera : cameras_.cameras) {
      if (camera.pose.name != found.pose.name) continue;
      EXPECT_LT((found.pose.world_from_camera.translation() - camera.pose.world_from_camera.translation()).norm(),
                0.001)
          << found.pose.name;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, SeenRobotOfRecord, testing::ValuesIn(kRobotsOnRigs),
                         [](const auto& robot) { return robot.param; });

TEST(RobotFiles, EveryRobotHasItsOwn) {
  for (const std::string& robot : kRobots) {
    EXPECT_NO_THROW(load_tracker(kConfig + "robots/" + robot + "/tracker.yaml")) << robot;
    EXPECT_NO_THROW(require_unambiguous(read_ball_placement(kConfig + "robots/" + robot + "/balls.yaml"))) << robot;
  }
}

// The source's tables 6.4, 6.5 and 6.6.
TEST(RobotFiles, ExperimentsOnTheRigTakeTheSourcesTablesInTheirOrder) {
  using Rows = std::vector<std::pair<std::string, std::vector<double>>>;
  const std::map<std::string, Rows> tables = {
      {"6.4.1",
       {{"a", {0, 0}},
        {"b", {-320, 288}},
        {"c", {-320, 480}},
        {"d", {144, -16}},
        {"e", {448, -16}},
        {"f", {-16, -16}},
        {"g", {336, 304}}}},
      {"6.4.2",
       {{"a", {0, 0}},
        {"b", {0, 258}},
        {"c", {0, 0}},
        {"d", {129, 0}},
        {"e", {258, -129}},
        {"f", {0, 0}},
        {"g", {129, 129}},
        {"h", {258, 258}}}},
  };
  ExperimentContext context;
  context.config_folder = SOFT_ROBOT_LAB_SOURCE "/config";
  for (const auto& [name, rows] : tables) {
    const GapSettings settings = read_gap_settings(context, name);
    const std::vector<MotorSettings>& motors = settings.files.lab.rig.motors;
    Rows found;
    for (const Configuration& one : settings.configurations)
      found.push_back({one.name, {steps_of(motors[0], one.commands[0]), steps_of(motors[1], one.commands[1])}});
    EXPECT_EQ(found, rows) << name;
  }
  const GapSettings air = read_gap_settings(context, "6.4.3");
  EXPECT_TRUE(air.pneumatic);
  std::string letters;
  for (const Configuration& one : air.configurations) letters += one.name;
  EXPECT_EQ(letters, "abcdefghi");
  EXPECT_EQ(air.configurations[5].commands, (std::vector<double>{0, 30, 30}));
  EXPECT_EQ(air.configurations[8].commands, (std::vector<double>{0, 0, 80}));
}

}  // namespace
}  // namespace soft_robot_lab
