// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/control/motion/plan_motion.h"

#include <cmath>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

std::string file(const std::string& curve, const std::string& rest = "tolerance_m: 0.0005, duration_s: 20") {
  return "{marker: tip, plane: {center_m: [0.01, 0, -0.09], across: [2, 0, 0], up: [0, 0, 1]}, curve: {" + curve +
         "}, " + rest + "}";
}

PathTask task(const std::string& text) { return parse_path_task(text, "path.yaml"); }

TEST(PathTask, ReadsACircleInItsPlane) {
  const PathTask circle = task(file("circle: {diameter_m: 0.015}"));
  EXPECT_EQ(circle.marker, "tip");
  EXPECT_NEAR(circle.curve.length_m(), M_PI * 0.015, 1e-6);
  for (int i = 0; i <= 50; ++i) {
    const Eigen::Vector3d from_center_m =
        circle.curve.at(circle.curve.length_m() * i / 50) - Eigen::Vector3d(0.01, 0, -0.09);
    EXPECT_NEAR(from_center_m.norm(), 0.0075, 1e-6);
    EXPECT_EQ(from_center_m.y(), 0.0);
  }
}

TEST(PathTask, AFigureEightIsAsWideAndHighAsAsked) {
  const PathTask eight = task(file("figure_eight: {width_m: 0.03, height_m: 0.015}"));
  double most_x_m = 0.0, most_z_m = 0.0;
  for (int i = 0; i <= 2000; ++i) {
    const Eigen::Vector3d position_m = eight.curve.at(eight.curve.length_m() * i / 2000);
    most_x_m = std::max(most_x_m, position_m.x() - 0.01);
    most_z_m = std::max(most_z_m, position_m.z() + 0.09);
  }
  EXPECT_NEAR(most_x_m, 0.015, 1e-5);
  EXPECT_NEAR(most_z_m, 0.0075, 1e-5);
}

TEST(PathTask, AnSvgPathIsScaledAndUpright) {
  const PathTask task_of_svg =
      task(file("svg_path: {d: \"M 100 50 h 20 v 10 z\", size_m: 0.004}"));  // corner top right
  const Curve& curve = task_of_svg.curve;
  EXPECT_NEAR(curve.length_m(), 0.004 + 0.002 + std::hypot(0.004, 0.002), 1e-9);
  EXPECT_TRUE(curve.at(0.0).isApprox(Eigen::Vector3d(0.008, 0, -0.089), 1e-9));
  EXPECT_TRUE(curve.at(0.004).isApprox(Eigen::Vector3d(0.012, 0, -0.089), 1e-9));
  EXPECT_TRUE(curve.at(0.006).isApprox(Eigen::Vector3d(0.012, 0, -0.091), 1e-9));
  EXPECT_THROW(task(file("svg_path: {d: \"M 1 1 z\", size_m: 0.004}")), SettingsError);
  EXPECT_THROW(task(file("svg_path: {d: \"M 1 1 A\", size_m: 0.004}")), SettingsError);
  EXPECT_THROW(task(file("svg_path: {d: \"M 1 1 L 2 2\", size_m: 0}")), SettingsError);
}

TEST(PathTask, APolylineGoesStraightAndASplineThroughItsPoints) {
  const PathTask line = task(file("polyline_m: [[0, 0], [0.003, 0], [0.003, 0.004]]"));
  EXPECT_NEAR(line.curve.length_m(), 0.007, 1e-12);
  EXPECT_TRUE(line.curve.at(0.005).isApprox(Eigen::Vector3d(0.013, 0, -0.088), 1e-9));
  EXPECT_TRUE(line.curve.at(-1).isApprox(Eigen::Vector3d(0.01, 0, -0.09), 1e-9));
  EXPECT_TRUE(line.curve.at(1).isApprox(Eigen::Vector3d(0.013, 0, -0.086), 1e-9));
  const PathTask spline = task(file("spline_m: [[0, 0], [0.003, 0], [0.003, 0.004]]"));
  double nearest_m = 1.0;
  for (int i = 0; i <= 1000; ++i) {
    const Eigen::Vector3d position_m = spline.curve.at(spline.curve.length_m() * i / 1000);
    nearest_m = std::min(nearest_m, (position_m - Eigen::Vector3d(0.013, 0, -0.09)).norm());
  }
  EXPECT_LT(nearest_m, 1e-5);
  EXPECT_GT(spline.curve.length_m(), 0.007);  // it swings out around the corner
}

TEST(PathTask, ReadsLimits) {
  const PathTask with = task(file("circle: {diameter_m: 0.015}",
                                  "tolerance_m: 0.001, duration_s: 0, samples: 12, limits: {left: {min: 0.7, max: 1.1, "
                                  "max_rate_per_s: 0.2, max_tension_n: 5}}"));
  ASSERT_EQ(with.bounds.size(), 1u);
  EXPECT_EQ(with.bounds[0].actuator, "left");
  EXPECT_EQ(with.bounds[0].max_rate_per_s, 0.2);
  EXPECT_EQ(with.bounds[0].max_tension_n, 5.0);
  EXPECT_EQ(with.samples, 12);
}

std::string refusal(const std::string& text) {
  try {
    task(text);
  } catch (const SettingsError& error) {
    return error.what();
  }
  return "";
}

TEST(PathTask, RefusalsNameFileKeyValueAndRange) {
  const auto expect = [](const std::string& text, const std::vector<std::string>& words) {
    const std::string said = refusal(text);
    for (const std::string& word : words) EXPECT_NE(said.find(word), std::string::npos) << word << " in: " << said;
  };
  expect(file("circle: {diameter_m: -1}"), {"path.yaml:1", "curve.circle.diameter_m", "-1", "(0, 1000]"});
  expect(file("square: {side_m: 1}"), {"square", "circle, figure_eight, polyline_m, spline_m"});
  expect(file(""), {"curve", "circle, figure_eight, polyline_m, spline_m"});
  expect(file("circle: {diameter_m: 0.01}", "tolerance_m: 0, duration_s: 1"), {"tolerance_m", "0", "(0, 1000]"});
  expect(file("circle: {diameter_m: 0.01}", "tolerance_m: 1, duration_s: -1"), {"duration_s", "-1", "[0,"});
  expect(file("circle: {diameter_m: 0.01}", "tolerance_m: 1, duration_s: 1, samples: 1"),
         {"samples", "1", "[2, 50000]"});
  expect(file("circle: {diameter_m: 0.01}", "tolerance_m: 1, duration_s: 1, speed: 3"), {"speed"});
  expect(file("polyline_m: [[0, 0], [0, 0]]"), {"polyline_m[1]", "1e-9 m"});
  expect(file("polyline_m: [[0, 0], [0, 2000]]"), {"polyline_m[1]", "[-1000, 1000]"});
  expect(file("polyline_m: [[0, 0]]"), {"polyline_m", "1 points", "[2, 500]"});
  expect(
      "{marker: tip, plane: {center_m: [0, 0, 0], across: [1, 0, 0], up: [1, 0, 1]}, curve: {circle: {diameter_m: "
      "0.01}}, tolerance_m: 1, duration_s: 1}",
      {"plane", "right angles"});
  expect(file("circle: {diameter_m: 0.01}", "tolerance_m: 1, duration_s: 1, limits: {left: {min: 1, max: 0.5}}"),
         {"limits.left", "max: 0.5", "min"});
}

TEST(PathTask, AllOfThePackageAreReadable) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(SOFT_ROBOT_LAB_SOURCE "/config/tasks/paths")) {
    EXPECT_GT(load_path_task(entry.path()).curve.length_m(), 0.0) << entry.path();
    ++count;
  }
  EXPECT_GT(count, 0);
}

}  // namespace
}  // namespace soft_robot_lab
