// SPDX-License-Identifier: BSD-3-Clause
// Cables that are in the air at rest, where the body bends into them.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "mechanics/carved_mesh.h"
#include "soft_robot_lab/mechanics/actuators/cable.h"
#include "soft_robot_lab/mechanics/simulation.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

const Eigen::Vector3d kEnd(1, 1, 1);

// A beam of 100 x 10 x 10 mm, held at its left end, with a post of 5 mm on each end of its upper side. The cable does
// not pull: it is at a tension of 0.
Simulation bridge(const std::string& points_m, double end_force_n) {
  Body body(carved({0, -0.005, 0}, {0.1, 0.005, 0.015}, {10, 1, 3},
                   [](const Eigen::Vector3d& at_m) { return at_m.z() < 0.01 || at_m.x() < 0.01 || at_m.x() > 0.09; }),
            {264200.0, 0.45, 1070.0});
  body.fix_nodes(-kEnd, {1e-6, 1, 1}, {true, true, true});
  body.add_force({0.099999, -1, -1}, kEnd, {0, 0, end_force_n});
  std::vector<std::unique_ptr<Actuator>> actuators;
  actuators.push_back(std::make_unique<Cable>());
  actuators[0]->initialise(
      YamlNode::parse("{name: top, command: tension_n, points_m: " + points_m + ", plug_radius_m: 0.002}", "test"),
      body, MeshLocator(body.mesh()));
  return Simulation(std::move(body), std::move(actuators), {}, {});
}

const std::string kOverTheBeam = "[[0.004, 0, 0.0135], [0.096, 0, 0.0135]]";
const std::string kInTheBeam =
    "[[0, 0, 0.005], [0.025, 0, 0.005], [0.05, 0, 0.005], [0.075, 0, 0.005], [0.096, 0, 0.005]]";

std::vector<SolveWarning> of_silicone(const SolveReport& report) {
  std::vector<SolveWarning> found;
  for (const SolveWarning& warning : report.warnings)
    if (warning.kind == "cable_in_silicone") found.push_back(warning);
  return found;
}

TEST(AirSpan, ThatTheBodyBendsIntoIsNamedWithItsDepthAndPlace) {
  Simulation bent = bridge(kOverTheBeam, -0.05);
  const SolveReport report = bent.solve_equilibrium();
  ASSERT_TRUE(report.converged) << report.message;
  const std::vector<SolveWarning> warnings = of_silicone(report);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].actuator, "top");
  EXPECT_GT(warnings[0].size, 0.0005);
  EXPECT_LT(warnings[0].size, 0.005) << "the beam's half thickness";
  EXPECT_NEAR(warnings[0].rest_position_m->z(), 0.01 - warnings[0].size, 0.001);
  EXPECT_NEAR(warnings[0].rest_position_m->x(), 0.03, 0.02) << "where it bends most, between the posts";
  EXPECT_EQ(bent.unmodelled_contact().size(), 1u);
}

TEST(AirSpan, ThatStaysInTheAirIsNot) {
  for (const double end_force_n : {-0.005, 0.0, 0.05}) {
    Simulation bent = bridge(kOverTheBeam, end_force_n);
    const SolveReport report = bent.solve_equilibrium();
    ASSERT_TRUE(report.converged) << report.message;
    EXPECT_TRUE(of_silicone(report).empty()) << end_force_n;
  }
}

TEST(AirSpan, IsNoneOfACableInSilicone) {
  for (const double end_force_n : {-0.05, 0.05}) {
    Simulation bent = bridge(kInTheBeam, end_force_n);
    const SolveReport report = bent.solve_equilibrium();
    ASSERT_TRUE(report.converged) << report.message;
    EXPECT_TRUE(of_silicone(report).empty()) << end_force_n;
  }
}

}  // namespace
}  // namespace soft_robot_lab
