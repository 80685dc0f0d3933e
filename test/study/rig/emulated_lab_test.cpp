// SPDX-License-Identifier: BSD-3-Clause
// Firmware, shafts, a robot that is not its model, cameras and tracker in lock-step; coarse and with exact cameras.
#include "study/rig/emulated_lab.h"

#include <gtest/gtest.h>

#include "robot/scene/scene_files.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"

namespace soft_robot_lab {
namespace {

const std::string kConfig = SOFT_ROBOT_LAB_SOURCE "/config/";

SceneOptions options() {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  return options;
}

class EmulatedLabTest : public testing::Test {
 protected:
  EmulatedLabSettings settings(const std::string& more = "backlash_steps: {left: 8}\n") const {
    const std::string plant = folder_.write(
        "plant.yaml", "robot: {include: " + kConfig + "robots/spinebot/robot.yaml, body: {element_size_m: 0.03, " +
                          "material: {stiffness_ratio: 1.3}}, cables: {left: {pull_speed_m_s: 0}, " +
                          "right: {pull_speed_m_s: 0}}}\n" + more);
    EmulatedLabSettings lab{load_rig(kConfig + "robots/spinebot/motors.yaml"), load_plant(plant),
                            read_camera_setup(kConfig + "cameras/box.yaml"),
                            load_tracker(kConfig + "robots/spinebot/tracker.yaml")};
    lab.film.sensor = SensorModel{};
    lab.frames = 1;
    lab.emulator = SOFT_ROBOT_LAB_RIG_EMULATOR;
    return lab;
  }

  SceneFolder folder_;
};

double farthest_m(const MarkerPlaces& one, const MarkerPlaces& other) {
  double most_m = 0.0;
  for (const auto& [name, position_m] : one) most_m = std::max(most_m, (other.at(name) - position_m).norm());
  return most_m;
}

TEST_F(EmulatedLabTest, PullsTheCablesAsFarAsTheSpoolsTurn) {
  EmulatedLab lab(settings(), options());
  const Simulation& real = lab.plant().simulation();
  lab.go({"left"}, {0.9});
  EXPECT_NEAR(real.actuator_state(0).command, 1.0 - 129 * 6.25e-5 / 0.0805, 1e-9);
  // On the way back the shaft first turns through the backlash, of which the driver knows nothing.
  lab.go({"left"}, {0.95});
  EXPECT_NEAR(real.actuator_state(0).command, 1.0 - (64 + 8) * 6.25e-5 / 0.0805, 1e-9);
  EXPECT_EQ(real.actuator_state(1).command, 1.0);
  EXPECT_EQ(lab.plant().failed_steps(), 0);
  EXPECT_GT(lab.time_s(), 129 / 320.0);
}

TEST_F(EmulatedLabTest, MeasuresAndRepeatsToTheLastDigit) {
  const Scene model = load_scene(kConfig + "robots/spinebot/robot.yaml", options());
  std::vector<RestRecord> records;
  for (int run = 0; run < 2; ++run) {
    EmulatedLab lab(settings(), options());
    records.push_back(record_at_rest(lab, *model.simulation, {1.0, 0.95}));
  }
  const RestRecord& record = records.front();
  EXPECT_EQ(record.actuators, (std::vector<std::string>{"left", "right"}));
  EXPECT_EQ(record.measured_m.size(), 6u);
  EXPECT_LT(farthest_m(record.measured_m, record.true_m), 5e-4);
  EXPECT_GT(farthest_m(record.simulated_m, record.true_m), 1e-4);
  EXPECT_EQ(farthest_m(record.measured_m, records.back().measured_m), 0.0);
  EXPECT_EQ(farthest_m(record.true_m, records.back().true_m), 0.0);
}

TEST_F(EmulatedLabTest, ObservesMarkersWithinTheirCovarianceWhichIsLeastAcrossTheSight) {
  EmulatedLabSettings noisy = settings();
  noisy.film.sensor.reset();  // that of the rig: D415
  EmulatedLab lab(noisy, options());
  const MarkerPlaces true_m = lab.plant().markers_m();
  const std::vector<MeasuredMarker> observed = lab.observe(true_m);
  EXPECT_EQ(observed.size(), 6u);
  for (const MeasuredMarker& marker : observed) {
    const Eigen::Vector3d off_m = marker.position_m - true_m.at(marker.name);
    EXPECT_LT(off_m.dot(marker.covariance_m2.inverse() * off_m), 16.3) << marker.name;  // 99.9 % of three numbers
    EXPECT_LT(marker.covariance_m2(0, 0), 0.25 * marker.covariance_m2(1, 1)) << marker.name;
  }
}

TEST_F(EmulatedLabTest, PressesSyringesAsFarAsTheirSpindlesTurn) {
  EmulatedLabSettings air = settings();
  air.rig = load_rig(kConfig + "robots/bubblefinger/motors.yaml");
  air.plant = load_plant(folder_.write(
      "finger.yaml", "robot: {include: " + kConfig + "robots/bubblefinger/robot.yaml, body: {element_size_m: 0.03}, " +
                         "chambers: {main: {flow_ml_s: 0}}}\nbacklash_steps: {main: 4}\n"));
  EmulatedLab lab(air, options());
  const Simulation& real = lab.plant().simulation();
  lab.go({"main"}, {5.0});
  EXPECT_NEAR(real.actuator_state(0).command, 99 * 0.0503, 1e-9);
  lab.go({"main"}, {0.0});
  EXPECT_NEAR(real.actuator_state(0).command, 4 * 0.0503, 1e-9);  // short of its zero by its backlash
  EXPECT_EQ(lab.plant().failed_steps(), 0);
}

TEST_F(EmulatedLabTest, RobotAndModelFollowTheSameCommandsInTheSameOrder) {
  const std::unique_ptr<Simulation> model = load_scene(kConfig + "robots/spinebot/robot.yaml", options()).simulation;
  model->solve_equilibrium();
  const SimulationState hanging = model->state();
  EmulatedLab lab(settings(), options());
  const RestRecord before = record_at_rest(lab, *model, {1.0, 1.0});
  record_at_rest(lab, *model, {0.9, 1.0});
  const double pulled_s = model->state().time_s;
  const RestRecord again = record_at_rest(lab, *model, {1.0, 1.0});
  EXPECT_GT(pulled_s, hanging.time_s + 0.3);         // at its drives' speed
  EXPECT_GT(model->state().time_s, pulled_s + 0.3);  // from there, not from hanging
  EXPECT_LT(farthest_m(before.simulated_m, again.simulated_m), 1e-5);
  EXPECT_GT(farthest_m(before.true_m, again.true_m), 1e-4);  // its left motor has backlash
}

TEST_F(EmulatedLabTest, FindsCamerasThatWereKnockedOutOfTheirPlace) {
  EmulatedLab lab(settings("cameras: {camera_left: {translation_m: [0.003, 0, 0]}, "
                           "camera_right: {translation_m: [0.003, 0, 0]}}\n"),
                  options());
  const MarkerPlaces true_m = lab.plant().markers_m();
  EXPECT_NEAR(farthest_m(lab.measure(true_m), true_m), 0.003, 5e-4);
  lab.calibrate(read_ball_placement(kConfig + "robots/spinebot/balls.yaml"));
  EXPECT_LT(farthest_m(lab.measure(true_m), true_m), 5e-4);
}

// Pulled by both cables Hammerbot buckles across their plane, to one of two sides.
TEST_F(EmulatedLabTest, KnowsWhereTheMirrorImageRestsToo) {
  const std::unique_ptr<Simulation> model = load_scene(kConfig + "robots/hammerbot/robot.yaml", options()).simulation;
  model->solve_equilibrium();
  const MarkerPlaces hanging_m = marker_places(*model);
  EXPECT_LT(farthest_m(hanging_m, rest_from_mirror_image(*model, 1).value()), 1e-4);
  for (const double contraction : {0.95, 0.9, 0.85, 0.8}) {
    model->set_command("left", contraction);
    model->set_command("right", contraction);
    model->solve_equilibrium();
  }
  const MarkerPlaces here_m = marker_places(*model);
  const MarkerPlaces there_m = rest_from_mirror_image(*model, 1).value();
  EXPECT_GT(std::abs(here_m.at("tip").y() - hanging_m.at("tip").y()), 0.005);
  EXPECT_NEAR(there_m.at("tip").y(), -here_m.at("tip").y(), 0.001);
  EXPECT_NEAR(there_m.at("tip").z(), here_m.at("tip").z(), 0.001);  // which sits in the plane, unlike those in front
  EXPECT_EQ(farthest_m(here_m, marker_places(*model)), 0.0);        // the model itself stays
}

TEST_F(EmulatedLabTest, RefusesWhatDoesNotBelongTogether) {
  EXPECT_THROW(EmulatedLab(settings("backlash_steps: {middle: 8}\n"), options()), std::invalid_argument);
  EXPECT_THROW(EmulatedLab(settings("cameras: {camera_top: {}}\n"), options()), std::invalid_argument);
  EmulatedLabSettings other_units = settings();
  other_units.rig = load_rig(kConfig + "robots/bubblefinger/motors.yaml");
  EXPECT_THROW(EmulatedLab(other_units, options()), std::invalid_argument);
  EmulatedLabSettings no_frames = settings();
  no_frames.frames = 0;
  EXPECT_THROW(EmulatedLab(no_frames, options()), std::invalid_argument);
  EmulatedLab lab(settings(), options());
  EXPECT_THROW(lab.go({"left"}, {0.5}), std::invalid_argument);  // beyond the motor's limits
}

}  // namespace
}  // namespace soft_robot_lab
