// SPDX-License-Identifier: BSD-3-Clause
// Via points that a cable sets by itself, one in every element that it crosses.
#include <cmath>
#include <memory>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "mechanics/box_mesh.h"
#include "soft_robot_lab/mechanics/actuators/cable.h"
#include "soft_robot_lab/settings/yaml_node.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {
namespace {

// 60 x 20 x 20 mm in 3 x 2 x 2 cells of six tetrahedra around a diagonal, of which a line along x, off the cells' edges
// and diagonals, crosses three.
ActuatorReading at_rest(const std::string& settings) {
  Body body(box_mesh({0, -0.01, -0.01}, {0.06, 0.01, 0.01}, {3, 2, 2}), Material{});
  const MeshLocator locator(body.mesh());
  Cable cable;
  cable.initialise(YamlNode::parse("{name: cable, " + settings + "}", "cable.yaml"), body, locator);
  return cable.observe(body.mesh().nodes_m, {0.0}, cable.rest_state());
}

TEST(ViaPoints, AreOneForEveryElementThatTheCableCrosses) {
  const std::string line = "points_m: [[0, 0.0037, 0.0021], [0.06, 0.0037, 0.0021]]";
  EXPECT_EQ(at_rest(line).path_m.size(), 2u);
  EXPECT_EQ(at_rest(line + ", via_points: given").path_m.size(), 2u);
  EXPECT_EQ(at_rest(line + ", via_points: per_element").path_m.size(), 2u + 9u);
  // Backwards, and over the two cells that it reaches.
  EXPECT_EQ(at_rest("points_m: [[0.06, 0.0037, 0.0021], [0, 0.0037, 0.0021]], via_points: per_element").path_m.size(),
            2u + 9u);
  EXPECT_EQ(at_rest("points_m: [[0, 0.0037, 0.0021], [0.04, 0.0037, 0.0021]], via_points: per_element").path_m.size(),
            2u + 6u);
}

TEST(ViaPoints, AreOneForThoseThatShareTheEdgeAlongWhichItRuns) {
  EXPECT_EQ(at_rest("points_m: [[0, 0, 0], [0.06, 0, 0]], via_points: per_element").path_m.size(), 2u + 3u);
}

TEST(ViaPoints, StandBesideThoseThatAreGiven) {
  // Of the nine elements one has a given point inside already.
  const ActuatorReading cable = at_rest(
      "points_m: [[0, 0.0037, 0.0021], [0.025, 0.0037, 0.0021], [0.06, 0.0037, 0.0021]], via_points: per_element");
  EXPECT_EQ(cable.path_m.size(), 3u + 8u);
  double nearest_m = 1.0;
  for (const Eigen::Vector3d& point : cable.path_m)
    nearest_m = std::min(nearest_m, (point - Eigen::Vector3d(0.025, 0.0037, 0.0021)).norm());
  EXPECT_LT(nearest_m, 1e-9);
}

TEST(ViaPoints, LeaveTheRestLengthAndRunAlongTheLine) {
  const Eigen::Vector3d from(0, 0.0037, 0.0021), to(0.06, -0.0043, 0.0052);
  const ActuatorReading cable = at_rest(
      "points_m: [[0, 0.0037, 0.0021], [0.06, -0.0043, 0.0052]], via_points: per_element, sheath_radius_m: 0, "
      "plug_radius_m: 0");
  EXPECT_GT(cable.path_m.size(), 8u);
  EXPECT_NEAR(*cable.rest_length_m, (to - from).norm(), 1e-12);
  double along = -1.0;
  for (const Eigen::Vector3d& point : cable.path_m) {
    const double next = (point - from).dot(to - from) / (to - from).squaredNorm();
    EXPECT_GT(next, along);
    along = next;
  }
}

// A bar held at both ends that sags under a load, with a cable of 2000 N/m through its middle.
ActuatorReading sagging(const std::string& via_points, int hand_set) {
  Body body(box_mesh({0, -0.01, -0.01}, {0.13, 0.01, 0.01}, {12, 2, 2}), Material{264200.0, 0.499, 1070.0});
  body.fix_nodes({-1, -1, -1}, {1e-6, 1, 1}, {true, true, true});
  body.fix_nodes({0.129999, -1, -1}, {1, 1, 1}, {true, true, true});
  body.add_traction({-1, 0.009999, -1}, {1, 1, 1}, {0, -2000.0, 0});
  const MeshLocator locator(body.mesh());
  std::ostringstream settings;
  settings << "{name: cable, compliance_m_n: 5.0e-4, via_points: " << via_points << ", points_m: [";
  for (int i = 0; i <= hand_set + 1; ++i)
    settings << (i ? ", [" : "[") << 0.13 * i / (hand_set + 1) << ", 0.0013, 0.0007]";
  settings << "]}";
  std::vector<std::unique_ptr<Actuator>> cables;
  cables.push_back(std::make_unique<Cable>());
  cables[0]->initialise(YamlNode::parse(settings.str(), "bar"), body, locator);
  Simulation simulation(std::move(body), std::move(cables), {}, {});
  simulation.set_command("cable", 0.98);
  EXPECT_TRUE(simulation.solve_equilibrium().converged);
  return simulation.actuator_state(0);
}

TEST(ViaPoints, ComeToWhatManyHandSetOnesSay) {
  const ActuatorReading many = sagging("given", 60), own = sagging("per_element", 0), none = sagging("given", 0);
  EXPECT_GT(own.path_m.size(), 20u);
  EXPECT_NEAR(*own.tension_n, *many.tension_n, 0.01 * *many.tension_n);
  EXPECT_NEAR(*own.length_m, *many.length_m, 2e-5);
  // Between held ends a cable without via points cannot know that the bar sags.
  EXPECT_NEAR(*none.length_m, 0.13, 1e-9);
  EXPECT_GT(*many.length_m, 0.1302);
  EXPECT_GT(*many.tension_n, 1.05 * *none.tension_n);
}

TEST(ViaPoints, RefuseAnotherWord) {
  try {
    at_rest("points_m: [[0, 0, 0], [0.06, 0, 0]], via_points: many");
    FAIL();
  } catch (const SettingsError& error) {
    EXPECT_NE(std::string(error.what()).find("via_points: 'many' is not one of given, per_element"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace soft_robot_lab
