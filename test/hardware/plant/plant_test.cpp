// SPDX-License-Identifier: BSD-3-Clause
// A second simulation that plays plant.
#include "hardware/plant/plant.h"

#include <cmath>

#include <gtest/gtest.h>

#include "robot/scene/scene_files.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "hardware/plant/real_time_plant.h"
#include "hardware/plant/same_commands.h"

namespace soft_robot_lab {
namespace {

SceneOptions options() {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  return options;
}

const char* const kStiffer = R"(robot:
  include: bar.yaml
  body: {material: {stiffness_ratio: 1.5}}
  cables: {left: {model: friction, friction_coefficient: 0.1, length_offset_m: 0.001}}
backlash_steps: {left: 4}
cameras: {camera_left: {translation_m: [0.002, 0, 0], rotation_deg: [0, 0, 90]}}
)";

class PlantTest : public testing::Test {
 protected:
  PlantSettings settings(const std::string& text) const { return load_plant(folder_.write("plant.yaml", text)); }
  Plant plant(const std::string& text = kStiffer) const { return {settings(text), options()}; }

  std::string refusal(const std::string& text) const {
    try {
      plant(text);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  }

  SceneFolder folder_;
};

TEST_F(PlantTest, DiffersFromTheModelAsItsFileSays) {
  const Plant stiffer = plant();
  const Scene model = load_scene(folder_.path("bar.yaml"), options());
  EXPECT_NEAR(stiffer.simulation().body().material().youngs_modulus_pa, 1.5 * 264200, 1e-6);
  EXPECT_EQ(stiffer.simulation().body().material().density_kg_m3, 1070);
  const ActuatorReading left = stiffer.simulation().actuator_state(0);
  EXPECT_EQ(left.path_m.size(), 2u);  // as the model's
  EXPECT_NEAR(*left.slack_m, *left.rest_length_m + 0.001 - *left.length_m, 1e-9);
  model.simulation->solve_equilibrium();
  const double sag_m = -stiffer.markers_m().at("tip").y(), model_sag_m = -model.simulation->marker_position(0).y();
  EXPECT_NEAR(sag_m / model_sag_m, 1 / 1.5, 0.1);
}

TEST_F(PlantTest, FollowsTheShaftsInItsOwnTime) {
  Plant stiffer = plant();
  const double rest_m = *stiffer.simulation().actuator_state(1).length_m;
  stiffer.advance(0.01, {"right"}, {0.95});  // less than a time step
  EXPECT_EQ(stiffer.present().time_s, 0.0);
  for (int i = 0; i < 99; ++i) stiffer.advance(0.01, {"right"}, {0.95});
  EXPECT_NEAR(stiffer.present().time_s, 1.0, stiffer.simulation().options().time_step_s);
  EXPECT_NEAR(stiffer.previous().time_s, stiffer.present().time_s - stiffer.simulation().options().time_step_s, 1e-12);
  EXPECT_NEAR(*stiffer.simulation().actuator_state(1).length_m, 0.95 * rest_m, 0.01 * rest_m);
  EXPECT_EQ(stiffer.failed_steps(), 0);
}

TEST_F(PlantTest, ShaftsPressAirIntoItsChambers) {
  const std::string finger = "{include: " SOFT_ROBOT_LAB_SOURCE
                             "/config/robots/bubblefinger/robot.yaml, body: {element_size_m: 0.03}, "
                             "chambers: {main: {flow_ml_s: 0}}}";
  Plant robot = plant("robot: " + finger);
  const Eigen::Vector3d tip_m = robot.markers_m().at("tip");
  const Scene same = load_scene(folder_.write("finger.yaml", finger), options());  // asked for its rest state
  same.simulation->set_command("main", 5.0);
  ASSERT_TRUE(same.simulation->solve_equilibrium().converged);
  const ActuatorReading at_rest = same.simulation->actuator_state(0);
  for (int i = 0; i < 60; ++i) robot.advance(1.0 / 60, {"main"}, {std::min(5.0, 0.2 * i)});
  const ActuatorReading chamber = robot.simulation().actuator_state(0);
  const double more_ml = 1e6 * (*chamber.volume_m3 - *chamber.initial_volume_m3);
  EXPECT_NEAR(more_ml, 1e6 * (*at_rest.volume_m3 - *at_rest.initial_volume_m3), 0.05 * more_ml);
  EXPECT_GT(more_ml, 0.5);
  EXPECT_LT(more_ml, 5.0);  // the rest is pressed together
  const double p = *chamber.gauge_pressure_pa, closed_ml = 120.0 + 5.0 + 1e6 * *chamber.initial_volume_m3;
  EXPECT_NEAR((p + 101000) * (closed_ml + more_ml - 5.0) / (101000 * closed_ml), 1.0, 1e-6);
  const Eigen::Vector3d rest_m = same.simulation->marker_position(same.simulation->marker_index("tip"));
  EXPECT_LT(robot.markers_m().at("tip").y(), tip_m.y() - 0.001);
  EXPECT_NEAR(robot.markers_m().at("tip").y(), rest_m.y(), 0.0005);
  EXPECT_EQ(robot.failed_steps(), 0);
}

TEST_F(PlantTest, FeelsEveryPlaceOfTheShaftsHoweverLateItIs) {
  // A pull of 8 mm that takes half a second, reported every 10 ms.
  Plant punctual = plant(), late = plant();
  RealTimePlant in_time(punctual, 10.0), too_late(late, 10.0);
  Eigen::Vector3d halfway_m = Eigen::Vector3d::Zero();
  for (int i = 1; i <= 60; ++i) {
    const std::vector<double> shafts = {1.0, 1.0 - 0.0016 * std::min(i, 50)};
    in_time.add(10.0 + 0.01 * i, {"left", "right"}, shafts);
    too_late.add(10.0 + 0.01 * i, {"left", "right"}, shafts);
    in_time.advance(10.0 + 0.01 * i, 0.1, 5.0);
    if (i == 31) halfway_m = punctual.markers_m().at("tip");
  }
  for (int i = 0; i < 3; ++i) too_late.advance(10.6, 0.103, 5.0);  // no whole time steps, which rounding could miss
  EXPECT_NEAR(too_late.late_s(10.6), 0.291, 1e-9);
  EXPECT_NEAR((late.markers_m().at("tip") - halfway_m).norm(), 0.0, 1e-6);
  EXPECT_GT((punctual.markers_m().at("tip") - halfway_m).norm(), 0.002);
  for (int i = 0; i < 3; ++i) too_late.advance(10.6, 0.103, 5.0);  // makes up for it
  EXPECT_NEAR(too_late.late_s(10.6), 0.0, 1e-9);
  EXPECT_NEAR((late.markers_m().at("tip") - punctual.markers_m().at("tip")).norm(), 0.0, 1e-6);
}

TEST_F(PlantTest, LosesTimeOnlyWhereItIsTooLate) {
  Plant robot = plant();
  RealTimePlant late(robot, 0.0);
  late.advance(1.0, 0.1, 2.0);
  EXPECT_EQ(late.lost_s(), 0.0);
  EXPECT_NEAR(late.late_s(1.0), 0.9, 1e-9);
  late.advance(5.0, 0.1, 2.0);
  EXPECT_NEAR(late.lost_s(), 2.8, 1e-9);
  EXPECT_NEAR(late.late_s(5.0), 2.0, 1e-9);
  late.add(3.5, {"right"}, {3.0});
  EXPECT_THROW(late.advance(5.0, 1.0, 2.0), std::invalid_argument);
  late.advance(5.0, 10.0, 2.0);  // time goes on
  EXPECT_NEAR(late.late_s(5.0), 0.0, 1e-9);
}

// A clock that is set back must not stop the robot until that time comes again.
TEST_F(PlantTest, GoesOnWhereTheClockIsSet) {
  Plant robot = plant();
  RealTimePlant late(robot, 1.8e9);
  const Eigen::Vector3d tip_m = robot.markers_m().at("tip");
  for (const double now_s : {1.8e9, 4.0e9, 0.0, 1.8e9}) {
    const double before_s = robot.present().time_s;
    for (int i = 0; i <= 10; ++i) late.advance(now_s + 0.01 * i, 0.1, 5.0);
    const double passed_s = robot.present().time_s - before_s;
    EXPECT_GT(passed_s, 0.05) << now_s;
    EXPECT_LT(passed_s, 11 * 0.1 + 1e-6) << now_s;  // where it was set ahead, as much as may be made up for
    EXPECT_LT(late.late_s(now_s + 0.1), 5.1) << now_s;
  }
  late.add(4.0e9, {"right"}, {0.9});  // was on its way when the clock was set
  for (int i = 0; i < 100; ++i) late.advance(1.8e9 + 1.0 + 0.01 * i, 0.1, 5.0);
  EXPECT_GT((robot.markers_m().at("tip") - tip_m).norm(), 0.002);
}

TEST_F(PlantTest, RefusesWhatNoShaftTells) {
  Plant stiffer = plant();
  const Eigen::Vector3d tip_m = stiffer.markers_m().at("tip");
  EXPECT_THROW(stiffer.advance(1.0, {"right", "left"}, {0.9, 3.0}), std::invalid_argument);
  EXPECT_THROW(stiffer.advance(1.0, {"right"}, {NAN}), std::invalid_argument);
  EXPECT_THROW(stiffer.advance(1.0, {"middle"}, {0.9}), std::invalid_argument);
  EXPECT_THROW(stiffer.advance(1.0, {"right"}, {}), std::invalid_argument);
  EXPECT_THROW(stiffer.advance(-1.0, {}, {}), std::invalid_argument);
  stiffer.advance(0.1, {}, {});
  EXPECT_NEAR((stiffer.markers_m().at("tip") - tip_m).norm(), 0.0, 1e-5);
}

TEST_F(PlantTest, MovesCamerasFromWhereTheyAreBelieved) {
  CameraSetup believed;
  believed.cameras.resize(2);
  believed.cameras[0].pose.name = "camera_left";
  believed.cameras[0].pose.world_from_camera.translation() = Eigen::Vector3d(1, 2, 3);
  believed.cameras[1].pose.name = "camera_right";
  const CameraSetup real = settings(kStiffer).shifted(believed);
  EXPECT_NEAR((real.cameras[0].pose.world_from_camera * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(1.002, 3, 3)).norm(),
              0.0, 1e-12);
  EXPECT_TRUE(real.cameras[1].pose.world_from_camera.isApprox(Eigen::Isometry3d::Identity()));
  believed.cameras.erase(believed.cameras.begin());
  EXPECT_THROW(settings(kStiffer).shifted(believed), std::invalid_argument);
}

TEST_F(PlantTest, IsReadStrictly) {
  EXPECT_EQ(settings(kStiffer).backlash_steps.at("left"), 4.0);
  const std::pair<const char*, const char*> cases[] = {
      {"backlash_steps: {left: 4}", "key 'robot' is missing"},
      {"robot: {include: bar.yaml}\nbacklash: {left: 4}", "unknown key 'backlash'"},
      {"robot: {include: bar.yaml}\nbacklash_steps: {left: -1}", "plant.yaml:2: backlash_steps.left: -1 is out of"},
      {"robot: {include: bar.yaml}\ncameras: {camera_left: {rotation_rad: [0, 0, 1]}}", "unknown key 'rotation_rad'"},
      {"robot: {include: bar.yaml, body: {colour: blue}}", "unknown key 'colour'"},
      {"robot: {include: bar.yaml, cables: {middle: {compliance_m_n: 0}}}", "'middle' is not one of left, right"},
      {"robot: {include: bar.yaml, body: {material: {stiffness_ratio: 0}}}", "stiffness_ratio: 0 is out of range"},
      {"robot: {include: bar.yaml, cables: {left: {length_offset_m: 0.011}}}", "length_offset_m: 0.011 is out of"},
  };
  for (const auto& [text, words] : cases)
    EXPECT_NE(refusal(text).find(words), std::string::npos) << text << "\n" << refusal(text);
}

TEST_F(PlantTest, ReadsEveryFileThatIsShipped) {
  using Shafts = std::map<std::string, double>;
  const std::map<std::string, Shafts> robots = {{"spinebot", {{"left", 0.95}, {"right", 1.05}}},
                                                {"hammerbot", {{"left", 0.95}, {"right", 1.05}}},
                                                {"bubblebot", {{"a", 5.0}, {"c", 2.0}}},
                                                {"bubblefinger", {{"main", 1.0}}},
                                                {"fibre_arm", {{"a", 2000.0}}}};
  for (const auto& [robot, shafts] : robots) {
    const std::string config = SOFT_ROBOT_LAB_SOURCE "/config/";
    const PlantSettings real = load_plant(config + "robots/" + robot + "/plant.yaml");
    EXPECT_NO_THROW(real.shifted(read_camera_setup(config + "cameras/box.yaml")));
    Plant hanging(real, options());
    std::vector<std::string> names;
    std::vector<double> values;
    for (const auto& [name, value] : shafts) {
      names.push_back(name);
      values.push_back(value);
    }
    hanging.advance(0.1, names, values);
    EXPECT_EQ(hanging.failed_steps(), 0);
  }
}

// One command goes to a simulation and to a rig of air.
TEST(SameCommands, OfChambersAreGaugePressures) {
  const std::string data = SOFT_ROBOT_LAB_SOURCE "/test/data/";
  const auto refusal = [&](const std::string& scene, const std::string& rig) -> std::string {
    try {
      require_same_commands(*load_scene(scene, options()).simulation, "scene", load_rig(rig), "rig");
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  const std::string robots = SOFT_ROBOT_LAB_SOURCE "/config/robots/";
  EXPECT_EQ(refusal(data + "scenes/air_finger.yaml", data + "plant/air_rig.yaml"), "");
  EXPECT_EQ(refusal(robots + "fibre_arm/robot.yaml", robots + "fibre_arm/pressures.yaml"), "");
  EXPECT_EQ(refusal(robots + "fibre_arm/robot.yaml", data + "plant/air_rig.yaml"),
            "rig has no channel for 'b' of scene");
  EXPECT_NE(
      refusal(robots + "bubblefinger/robot.yaml", robots + "fibre_arm/pressures.yaml").find("no channel for 'main'"),
      std::string::npos);
  EXPECT_NE(refusal(robots + "fibre_arm/robot.yaml", robots + "bubblebot/motors.yaml")
                .find("'a' as the gauge pressure [Pa], rig as the plunger's travel [ml]"),
            std::string::npos);
}

}  // namespace
}  // namespace soft_robot_lab
