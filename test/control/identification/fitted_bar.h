// SPDX-License-Identifier: BSD-3-Clause
// A coarse bar with two cables whose truth is known, to fit its model to.
#pragma once

#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/control/identification/fit_model.h"
#include "settings/overrides_from.h"

namespace soft_robot_lab {

inline const std::string kScene = std::string(SOFT_ROBOT_LAB_SOURCE) + "/test/data/scenes/cable_bar.yaml";
// As if the bar lay on its side: its weight bends it, and shows its stiffness.
inline const std::string kLying = "gravity_m_s2: [0, 9.81, 0]\n";

inline SceneOptions options_with(const std::string& overrides) {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  options.overrides = overrides_from(overrides);
  return options;
}

inline std::string cable(const std::string& name, double x, const std::string& rest) {
  const std::string place = std::to_string(x);
  return "{name: " + name + ", points_m: [[" + place + ", 0, 0], [" + place + ", 0, -0.05], [" + place +
         ", 0, -0.1]], " + rest + "}";
}

// Rest states of the scene as cameras would measure them.
inline std::vector<MeasuredPose> measure(const std::string& overrides,
                                         const std::vector<std::pair<double, double>>& contractions,
                                         const Eigen::Isometry3d& measured_from_base, double noise_m, unsigned seed) {
  const Scene scene = load_scene(kScene, options_with(overrides));
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::vector<MeasuredPose> poses;
  for (const auto& [left, right] : contractions) {
    scene.simulation->set_command("left", left);
    scene.simulation->set_command("right", right);
    EXPECT_TRUE(scene.simulation->solve_equilibrium().converged);
    MeasuredPose pose{{{"left", left}, {"right", right}}, {}};
    for (int m = 0; m < 2; ++m) {
      const Eigen::Vector3d noise = Eigen::Vector3d::NullaryExpr([&](int) { return normal(random); });
      pose.markers.push_back({scene.simulation->markers()[static_cast<std::size_t>(m)].name(),
                              measured_from_base * scene.simulation->marker_position(m) + noise_m * noise,
                              std::max(1e-5, noise_m) * std::max(1e-5, noise_m) * Eigen::Matrix3d::Identity()});
    }
    poses.push_back(std::move(pose));
  }
  return poses;
}

inline const std::vector<std::pair<double, double>> kWay = {{1.0, 1.0},  {0.95, 1.0}, {0.9, 1.0},   {0.95, 0.97},
                                                            {1.0, 0.95}, {1.0, 0.9},  {0.96, 0.93}, {0.93, 1.02}};

inline const FittedValue& value_of(const FitResult& result, const std::string& name) {
  for (const FittedValue& value : result.values)
    if (value.name == name) return value;
  throw std::out_of_range(name);
}

inline void expect_within(const FitResult& result, const std::string& name, double truth) {
  const FittedValue& value = value_of(result, name);
  EXPECT_NEAR(value.value, truth, 3.0 * value.deviation) << name << "\n" << summary(result);
  EXPECT_TRUE(value.identifiable) << name;
}

inline bool warns(const FitResult& result, const std::string& of) {
  for (const std::string& warning : result.warnings)
    if (warning.find(of) != std::string::npos) return true;
  return false;
}

}  // namespace soft_robot_lab
