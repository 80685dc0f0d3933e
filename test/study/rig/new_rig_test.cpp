// SPDX-License-Identifier: BSD-3-Clause
// new_rig as a user runs it: what it writes a session can read, and what it cannot serve it refuses.
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "hardware/plant/plant.h"
#include "hardware/plant/same_commands.h"
#include "perception/calibration/calibration_session.h"
#include "perception/calibration/camera_pose.h"
#include "robot/scene/scene_files.h"
#include "run_program.h"
#include "session/report/frame_recorder.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/perception/tracking/tracker_settings.h"

namespace soft_robot_lab {
namespace {

const char* const kBody = R"(body:
  solid: {cylinder: {start_m: [0, 0, 0], end_m: [0, 0, -0.1], radius_m: 0.012}}
  element_size_m: 0.02
  material: {preset: ecoflex_00_50}
  fixed: [{box: {min_m: [-1, -1, -1.0e-6], max_m: [1, 1, 1]}}]
gravity_m_s2: [0, 0, -9.81]
)";
const std::string kMarkers = "markers: [{name: tip, position_m: [0, 0, -0.1]}]\n";
const std::string kPath = "path_m: [[0.006, 0, 0], [0.006, 0, -0.09]]";
const std::string kCable = "cables: [{name: front, " + kPath + ", min_contraction: 0.8, pull_speed_m_s: 0.01}]\n";

SceneOptions options() {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  return options;
}

class NewRig : public testing::Test {
 protected:
  // The robot's file is finger.yaml, and the rig goes into `rig` beside it.
  Outcome write(const std::string& text, const std::string& arguments = "") const {
    folder_.write("finger.yaml", text);
    return run_program(SOFT_ROBOT_LAB_NEW_RIG, folder_,
                       "'" + folder_.path("finger.yaml") + "' --output '" + folder_.path("rig") + "' " + arguments);
  }

  std::string refusal(const std::string& text) const {
    const Outcome outcome = write(text);
    EXPECT_EQ(outcome.exit_status, 2) << outcome.out << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(folder_.path("rig/motors.yaml")));
    return outcome.err;
  }

  std::string file(const std::string& name) const { return folder_.path("rig/" + name); }

  SceneFolder folder_;
};

// By pictures without noise, without and with the balls.
void expect_calibrates_by_balls(const std::string& robot, const CameraSetup& cameras, const BallPlacement& placement) {
  const Scene scene = load_scene(robot, options());
  scene.simulation->solve_equilibrium();
  CalibrationSession calibration(placement, {}, 1);
  for (const RigCamera& camera : cameras.cameras)
    calibration.set_camera({camera.pose.name, camera.model, camera.pose.world_from_camera});
  const auto add = [&](const CameraSetup& seen) {
    const SimulationState& state = scene.simulation->state();
    for (const RgbdFrame& frame : FrameRecorder(*scene.simulation, seen).take(state, state, 0.0).frames)
      calibration.add(frame);
  };
  add(cameras);
  calibration.remember_without_balls();
  CameraSetup with_balls = cameras;
  for (const PlacedBall& ball : placement.balls)
    with_balls.surroundings.balls.push_back({ball.position_m, placement.radius_m, {0.9, 0.9, 0.9}});
  add(with_balls);
  for (const CameraCalibration& found : calibration.calibrate())
    EXPECT_EQ(found.seen.size(), placement.balls.size()) << found.pose.name;
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST_F(NewRig, WritesWhatASessionReads) {
  const Outcome outcome = write(kBody + kMarkers + kCable);
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  EXPECT_TRUE(contains(outcome.out, "robot:=finger scene:=" + folder_.path("finger.yaml"))) << outcome.out;
  const RigSettings rig = load_rig(file("motors.yaml"));
  ASSERT_EQ(rig.motors.size(), 1u);
  EXPECT_EQ(rig.motors[0].name, "front");
  EXPECT_EQ(rig.motors[0].min_value, 0.8);
  EXPECT_NEAR(-rig.motors[0].steps_per_value * rig.motors[0].step_m, 0.09, 1e-9);  // its length
  EXPECT_EQ(rig.motors[0].drive.max_speed_steps_s, 160);                           // 10 mm/s
  EXPECT_EQ(load_tracker(file("tracker.yaml")).marker_radius_m, 0.003);
  EXPECT_EQ(read_ball_placement(file("balls.yaml")).balls.size(), 5u);

  const PlantSettings settings = load_plant(file("plant.yaml"));
  EXPECT_GT(settings.backlash_steps.at("front"), 0);
  EXPECT_EQ(settings.cameras.size(), 2u);
  const Plant plant(settings, options());
  const Scene model = load_scene(folder_.path("finger.yaml"), options());
  EXPECT_NO_THROW(require_same_commands(plant.simulation(), "plant.yaml", rig, "motors.yaml"));
  EXPECT_NEAR(plant.simulation().body().material().youngs_modulus_pa,
              1.15 * model.simulation->body().material().youngs_modulus_pa, 1);
  EXPECT_TRUE(contains(contents(file("plant.yaml")), "element_size_m: 0.015 "));  // finer
  EXPECT_LT(plant.simulation().actuators()[0]->limits().min, 0.75);               // a shaft may overshoot
}

TEST_F(NewRig, TakesEveryLawOfACable) {
  const std::string rest = ", " + kPath + ", min_contraction: 0.9, ";
  const std::string third = "path_m: [[-0.006, 0, 0], [-0.006, 0, -0.09]]";
  const Outcome outcome =
      write(kBody + kMarkers + "cables:\n  - {name: 'a b'" + rest + "model: friction, friction_coefficient: 0.3}\n" +
            "  - {name: springs, path_m: [[0, 0.006, 0], [0, 0.006, -0.09]], min_contraction: 0.9, model: springs, "
            "stiffness_n_m: 2000, pull_delay_s: 0.1}\n" +
            "actuators: [{plugin: soft_robot_lab/Cable, name: other, " + third + ", min_contraction: 0.95}]\n");
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  EXPECT_EQ(load_rig(file("motors.yaml")).motors[0].name, "a b");
  EXPECT_EQ(load_plant(file("plant.yaml")).backlash_steps.size(), 3u);
}

const std::string kHollow = R"(body:
  solid:
    difference:
      - {cylinder: {start_m: [0, 0, 0], end_m: [0, 0, -0.1], radius_m: 0.015}}
      - {name: inside, box: {size_m: [0.01, 0.01, 0.07], center_m: [0, 0.004, -0.05]}}
  element_size_m: 0.02
  material: {preset: ecoflex_00_50}
  fixed: [{box: {min_m: [-1, -1, -1.0e-6], max_m: [1, 1, 1]}}]
)";

TEST_F(NewRig, WritesPressureChannelsForChambersByGaugePressure) {
  const std::string chamber = "chambers: [{name: main, surface: inside, command: gauge_pressure, ";
  const Outcome outcome = write(kHollow + kMarkers + chamber + "max_gauge_pressure_pa: 10000}]\n");
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  EXPECT_TRUE(contains(outcome.out, " drives:=pressures emulated:=true")) << outcome.out;
  EXPECT_FALSE(std::filesystem::exists(file("motors.yaml")));
  const RigSettings rig = load_rig(file("pressures.yaml"));
  ASSERT_EQ(rig.channels.size(), 1u);
  EXPECT_EQ(rig.channels[0].name, "main");
  EXPECT_EQ(rig.channels[0].max_value, 9000);
  EXPECT_EQ(rig.channels[0].sensor.full_pa, 10000);
  EXPECT_EQ(rig.channels[0].deadband_pa, 100);
  EXPECT_TRUE(load_plant(file("plant.yaml")).backlash_steps.empty());
  std::filesystem::remove_all(folder_.path("rig"));

  EXPECT_TRUE(contains(refusal(kHollow + kMarkers + chamber + "}]\n"), "max_gauge_pressure_pa: missing"));
  EXPECT_TRUE(contains(refusal(kHollow + kMarkers + kCable + chamber + "max_gauge_pressure_pa: 10000}]\n"),
                       "drives motors or pressure channels, not both"));
}

TEST_F(NewRig, KeepsWhatIsThereUnlessItIsForced) {
  ASSERT_EQ(write(kBody + kMarkers + kCable).exit_status, 0);
  folder_.write("rig/balls.yaml", "# mine\n");
  const Outcome refused = write(kBody + kMarkers + kCable);
  EXPECT_EQ(refused.exit_status, 2);
  EXPECT_TRUE(contains(refused.err, "there already: ") && contains(refused.err, "--force")) << refused.err;
  EXPECT_EQ(contents(file("balls.yaml")), "# mine\n");
  EXPECT_EQ(write(kBody + kMarkers + kCable, "--force").exit_status, 0);
  EXPECT_EQ(read_ball_placement(file("balls.yaml")).balls.size(), 5u);
}

TEST_F(NewRig, RefusesRobotsThatNoRigDrives) {
  EXPECT_TRUE(contains(refusal(kBody + kCable), "markers: missing; cameras follow a robot by its markers"));
  EXPECT_TRUE(contains(refusal(kBody + kMarkers), "has 0 actuators; a rig's board drives 1 to 6"));
  std::string seven = "cables:\n";
  for (int i = 0; i < 7; ++i) seven += "  - {name: c" + std::to_string(i) + ", " + kPath + ", min_contraction: 0.9}\n";
  EXPECT_TRUE(contains(refusal(kBody + kMarkers + seven), "has 7 actuators"));
  EXPECT_TRUE(contains(refusal(kBody + kMarkers + "cables: [{name: front, " + kPath + "}]\n"),
                       "finger.yaml:8: cables[0]: min_contraction: missing; a motor needs a limit"));
  EXPECT_TRUE(contains(
      refusal(kBody + kMarkers + "cables: [{name: front, " + kPath + ", command: tension_n, min_contraction: 0.9}]\n"),
      "cables[0]"));
  EXPECT_TRUE(contains(refusal(kBody + kMarkers + "actuators: [{plugin: my_lab/Muscle, name: biceps}]\n"),
                       "plugin: 'my_lab/Muscle' is neither a cable nor a chamber"));
  EXPECT_TRUE(contains(refusal(kBody + kMarkers + kCable + "solver: {method: reduced, commands: {front: [0.9, 1]}}\n"),
                       "the robot of an emulated rig is not reduced"));
  const std::string chamber =
      "chambers: [{name: main, surface: {solid: {box: {size_m: [0.01, 0.01, 0.05], center_m: [0, 0, -0.05]}}}}]\n";
  EXPECT_FALSE(refusal(kBody + kMarkers + chamber).empty());
  EXPECT_TRUE(contains(refusal("include: " SOFT_ROBOT_LAB_SOURCE "/config/robots/hollow_cuboid/robot.yaml\n"),
                       "chambers[0]: command: must be syringe, volume_offset or gauge_pressure"));
}

// Three times as large, before cameras of its own that show red stickers.
TEST_F(NewRig, TakesOtherCamerasAndOtherSizes) {
  folder_.write("cameras.yaml", R"(cameras:
  - {name: west, width_px: 848, height_px: 480, position_m: [-0.7, -1.4, -0.9], look_at_m: [0, 0, -0.15]}
  - {name: east, width_px: 848, height_px: 480, position_m: [0.7, -1.4, -0.9], look_at_m: [0, 0, -0.15]}
box: {size_m: [4, 4, 4], center_m: [0, 0, 0]}
lighting: {ambient: 0.7}
markers: {diameter_m: 0.02, colour: [0.8, 0.05, 0.1]}
)");
  const std::string large = R"(body:
  solid: {cylinder: {start_m: [0, 0, 0], end_m: [0, 0, -0.3], radius_m: 0.036}}
  element_size_m: 0.06
  fixed: [{box: {min_m: [-1, -1, -1.0e-6], max_m: [1, 1, 1]}}]
markers: [{name: tip, position_m: [0, 0, -0.3]}, {name: back, position_m: [0, 0.036, -0.15]}]
cables: [{name: front, path_m: [[0.02, 0, 0], [0.02, 0, -0.27]], min_contraction: 0.8}]
)";
  const Outcome outcome = write(large, "--cameras '" + folder_.path("cameras.yaml") + "'");
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  EXPECT_TRUE(contains(outcome.err, "does not see back at (0, 0.036, -0.15) m;")) << outcome.err;
  EXPECT_FALSE(contains(outcome.err, "tip")) << outcome.err;
  EXPECT_TRUE(contains(outcome.out, "camera_names:='[west, east]' overlay_camera:=west")) << outcome.out;
  const TrackerSettings tracker = load_tracker(file("tracker.yaml"));
  EXPECT_EQ(tracker.marker_radius_m, 0.01);
  EXPECT_EQ(tracker.detector.colours.at(0).name, "red");
  expect_calibrates_by_balls(folder_.path("finger.yaml"), read_camera_setup(folder_.path("cameras.yaml")),
                             read_ball_placement(file("balls.yaml")));
  const std::vector<CameraPose> poses = read_camera_poses(file("camera_poses.yaml"));
  const CameraSetup cameras = read_camera_setup(folder_.path("cameras.yaml"));
  ASSERT_EQ(poses.size(), 2u);
  for (std::size_t i = 0; i < poses.size(); ++i)
    EXPECT_TRUE(poses[i].world_from_camera.isApprox(cameras.cameras[i].pose.world_from_camera, 1e-6));
  EXPECT_EQ(load_plant(file("plant.yaml")).cameras.count("west"), 1u);
}

TEST_F(NewRig, SaysWhereItIsNotSeen) {
  const Outcome behind = write(std::string(kBody) + "markers: [{name: tip, position_m: [0, 0.012, -0.05]}]\n" + kCable);
  EXPECT_EQ(behind.exit_status, 1);
  EXPECT_TRUE(contains(behind.err, "does not see tip at (0, 0.012, -0.05) m;")) << behind.err;
}

TEST_F(NewRig, RefusesWhatCannotBeWritten) {
  folder_.write("rig", "a file\n");
  const Outcome no_folder = write(kBody + kMarkers + kCable);
  EXPECT_EQ(no_folder.exit_status, 2);
  EXPECT_TRUE(contains(no_folder.err, "is no folder")) << no_folder.err;
  const Outcome below =
      run_program(SOFT_ROBOT_LAB_NEW_RIG, folder_,
                  "'" + folder_.path("finger.yaml") + "' --output '" + folder_.path("rig/below") + "'");
  EXPECT_EQ(below.exit_status, 2);
  EXPECT_TRUE(contains(below.err, "cannot be made")) << below.err;
  EXPECT_EQ(contents(folder_.path("rig")), "a file\n");
  const Outcome missing = run_program(SOFT_ROBOT_LAB_NEW_RIG, folder_, "'" + folder_.path("none.yaml") + "'");
  EXPECT_EQ(missing.exit_status, 2);
  EXPECT_TRUE(contains(missing.err, "none.yaml")) << missing.err;
}

}  // namespace
}  // namespace soft_robot_lab
