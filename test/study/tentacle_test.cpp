// SPDX-License-Identifier: BSD-3-Clause
// The scene of the measured tentacle, against a converged rod at the same material, which was computed elsewhere.
#include <cmath>

#include <gtest/gtest.h>

#include "study/experiments/measured_tentacle.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"

namespace soft_robot_lab {
namespace {

const std::string kConfig = SOFT_ROBOT_LAB_SOURCE "/config/";
const std::string kRobot = kConfig + "robots/tentacle/robot.yaml";
const std::string kData = kConfig + "reference/tentacle/single_tendon_1.json";

SceneOptions options_with(const Overrides& overrides) {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  options.overrides = overrides;
  return options;
}

TEST(MeasuredTentacle, HasItsPosesWithWhatWasPublished) {
  const MeasuredTentacle tentacle = read_measured_tentacle(kData);
  ASSERT_EQ(tentacle.poses.size(), 7u);
  double identified_m = 0.0;
  for (const TentaclePose& pose : tentacle.poses) {
    EXPECT_EQ(pose.measured.markers.size(), 4u);
    EXPECT_EQ(pose.soromox_start_m.has_value(), pose.session == "A");
    identified_m += pose.soromox_identified_m / 7.0;
  }
  EXPECT_NEAR(identified_m, tentacle.soromox_identified_m, 1e-6);
  EXPECT_DOUBLE_EQ(tentacle.start.youngs_modulus_pa, 505000.0);
  EXPECT_THROW(read_measured_tentacle(kConfig + "nowhere.json"), std::runtime_error);
  EXPECT_THROW(read_measured_tentacle(kRobot), std::runtime_error);
}

// Of its own weight alone: 0.77 mm at M1 to 1.45 mm beyond the tip.
TEST(TentacleScene, HangsAsTheRodDoes) {
  const MeasuredTentacle tentacle = read_measured_tentacle(kData);
  const Scene scene = load_scene(kRobot, options_with(tentacle.identified.overrides()));
  scene.simulation->set_command("tendon_1", 0.0);
  ASSERT_TRUE(scene.simulation->solve_equilibrium().converged);
  for (const auto& [name, rod_m] : tentacle.hanging_rest_m) {
    const int marker = scene.simulation->marker_index(name);
    const double rest_z_m = scene.simulation->markers()[static_cast<std::size_t>(marker)].rest_position_m().z();
    const double sag_m = rest_z_m - scene.simulation->marker_position(marker).z(), rod_sag_m = rest_z_m - rod_m.z();
    EXPECT_NEAR(sag_m, rod_sag_m, 0.03 * rod_sag_m) << name;
  }
}

// The least tension, where shapes are alike whatever large bending does to a cross-section: it moves M4 by 0.08 m.
TEST(TentacleScene, BendsAsTheRodDoes) {
  const MeasuredTentacle tentacle = read_measured_tentacle(kData);
  const TentaclePose& pose = tentacle.poses.front();
  MeasuredPose rod = pose.measured;
  for (MeasuredMarker& marker : rod.markers) marker.position_m = pose.rod_m.at(marker.name);
  const TentacleGap gap = tentacle_gap(kRobot, options_with(tentacle.identified.overrides()), {rod});
  for (const auto& [name, off_m] : gap.offset_m) EXPECT_LT(off_m.norm(), 0.004) << name << " " << off_m.transpose();
}

}  // namespace
}  // namespace soft_robot_lab
