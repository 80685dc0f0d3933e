// SPDX-License-Identifier: BSD-3-Clause
// The robots with air chambers that the package brings along.
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "robot/scene/solve_watch.h"
#include "settings/words.h"
#include "soft_robot_lab/robot/scene/run_scene.h"
#include "settings/overrides_from.h"

namespace soft_robot_lab {
namespace {

const std::string kRobots = SOFT_ROBOT_LAB_SOURCE "/config/robots/";

Scene load(const std::string& file, const std::string& overrides = "") {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  options.overrides = overrides_from(overrides);
  return load_scene(kRobots + file + ".yaml", options);
}

// Chambers have plane walls, so every mesh holds their volume exactly.
void expect_chambers(const Simulation& simulation, const std::map<std::string, double>& volumes_m3) {
  ASSERT_EQ(simulation.actuators().size(), volumes_m3.size());
  for (const auto& [name, volume_m3] : volumes_m3) {
    const ActuatorReading reading = simulation.actuator_state(simulation.actuator_index(name));
    EXPECT_NEAR(*reading.initial_volume_m3 / volume_m3, 1.0, 1e-9) << name;
  }
}

void expect_rest(const std::string& robot, const std::map<std::string, double>& volumes_m3) {
  SCOPED_TRACE(robot);
  Scene scene = load(robot + "/robot");
  Simulation& simulation = *scene.simulation;
  expect_chambers(simulation, volumes_m3);
  for (const SolveReport& report : {simulation.solve_equilibrium(), simulation.step()}) {
    EXPECT_TRUE(report.converged) << report.message;
    EXPECT_EQ(report.inverted_elements, 0);
  }
  for (const auto& chamber : volumes_m3) {
    const ActuatorReading reading = simulation.actuator_state(simulation.actuator_index(chamber.first));
    EXPECT_LT(std::abs(*reading.gas_residual), 1e-6);
  }
  // The finer one differs by its mesh alone, which is not made here.
  expect_chambers(*load(robot + "/fine", "body: {element_size_m: 0.03, refinements: []}").simulation, volumes_m3);
}

TEST(ChamberRobots, HaveTheirVolumesAndComeToRest) {
  expect_rest("hollow_cuboid", {{"main", 2.36531e-5}});
  expect_rest("bubblefinger", {{"main", 1.9824e-5}});
  expect_rest("bubblebot", {{"a", 77.75e-6}, {"b", 77.75e-6}, {"c", 77.75e-6}});
}

// Faces of 6 mm follow its round wall of 2.2 mm: outer ones lie partly behind inner ones beside them, which pushed them
// out with 111 N.
TEST(ChamberRobots, TouchNothingAtRestWhereFacesFollowARoundWallRoughly) {
  Scene scene = load("fibre_finger/robot", "contact: {self: true}");
  Simulation& simulation = *scene.simulation;
  const SolveReport report = simulation.solve_equilibrium();
  EXPECT_TRUE(report.converged) << report.message;
  for (const ContactReading& contact : simulation.contacts()) EXPECT_EQ(contact.normal_force_n, 0.0) << contact.surface;
}

TEST(SolveWatch, SaysToWhatChambersHaveComeEverLessOften) {
  Scene scene = load("hollow_cuboid/robot");
  Simulation& simulation = *scene.simulation;
  simulation.set_command("main", 1.2);
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  const ActuatorReading reading = simulation.actuator_state(0);
  SolveWatch watch(simulation);
  watch.begin(100.0);
  EXPECT_EQ(watch.say(101.9), std::nullopt);
  const std::string chamber = "main: " + format_fixed(1e-3 * *reading.gauge_pressure_pa, 2) + " kPa, volume +" +
                              format_fixed(100.0 * (*reading.volume_m3 / *reading.initial_volume_m3 - 1.0), 0) + " %";
  EXPECT_EQ(watch.say(102.0), "solves for 2 s; " + chamber + "; Ctrl-C ends it");
  EXPECT_EQ(watch.say(102.7), std::nullopt);
  EXPECT_EQ(watch.say(103.0), "solves for 3 s; " + chamber + "; Ctrl-C ends it");
  watch.begin(103.0);
  EXPECT_EQ(watch.say(104.5), std::nullopt);
}

}  // namespace
}  // namespace soft_robot_lab
