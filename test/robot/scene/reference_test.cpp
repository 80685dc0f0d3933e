// SPDX-License-Identifier: BSD-3-Clause
// Scenes of the package against reference solutions (config/reference).
#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "reference_table.h"
#include "scene_files.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/robot/scene/run_scene.h"

namespace soft_robot_lab {
namespace {

// How far the scene's first marker moves, with `changes` on top of a scene of the package; `iterations_a_solve` at
// most.
Eigen::Vector3d displacement_m(const std::string& scene_name, const std::string& overrides,
                               int iterations_a_solve = 10) {
  const SceneFolder folder;
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  const std::string base = std::string(SOFT_ROBOT_LAB_SOURCE) + "/config/scenes/" + scene_name + ".yaml";
  Scene scene = load_scene(folder.write("scene.yaml", "include: " + base + "\n" + overrides), options);
  const RunReport report = run_scene(scene);
  EXPECT_TRUE(report.solve.converged) << report.solve.message;
  EXPECT_LE(report.solve.iterations, iterations_a_solve * std::max(1, report.solve.steps));
  return scene.simulation->marker_position(0) - scene.simulation->markers()[0].rest_position_m();
}

void expect_near(const Eigen::Vector3d& found_m, const Eigen::Vector3d& expected_m, double relative) {
  EXPECT_LT((found_m - expected_m).norm(), relative * expected_m.norm())
      << found_m.transpose() << " instead of " << expected_m.transpose();
}

TEST(Reference, CantileverSagsUnderItsWeight) {
  for (const ReferenceRow& row : read_reference("r1_cantilever")) {
    if (row.text("law") != "iso") continue;
    SCOPED_TRACE(row.text("nu"));
    const Eigen::Vector3d found_m = displacement_m(
        "cantilever", "body: {element_size_m: 0.008, material: {poissons_ratio: " + row.text("nu") + "}}\n");
    expect_near(found_m, {row.number("tip_ux_m"), row.number("tip_uy_m"), 0.0}, 0.01);
  }
}

TEST(Reference, CantileverConvergesToHalfAPerCent) {
  const ReferenceRow row = read_reference("r1_cantilever").at(2);
  const Eigen::Vector3d found_m = displacement_m(
      "cantilever", "body: {element_size_m: 0.006, material: {poissons_ratio: " + row.text("nu") + "}}\n");
  expect_near(found_m, {row.number("tip_ux_m"), row.number("tip_uy_m"), 0.0}, 0.005);
}

TEST(Reference, CantileverNeedsSixIterationsHoweverIncompressible) {
  for (const std::string poissons_ratio : {"0.45", "0.49", "0.499", "0.4999", "0.499999"}) {
    SCOPED_TRACE(poissons_ratio);
    const Eigen::Vector3d found_m =
        displacement_m("cantilever", "body: {material: {poissons_ratio: " + poissons_ratio + "}}\n", 6);
    EXPECT_NEAR(found_m.y(), -0.0147, 0.0003);
  }
}

TEST(Reference, CantileverSettlesAtSixtyHertz) {
  for (const ReferenceRow& row : read_reference("r1_cantilever")) {
    if (row.text("law") != "iso") continue;
    SCOPED_TRACE(row.text("nu"));
    const Eigen::Vector3d found_m =
        displacement_m("cantilever",
                       "body: {element_size_m: 0.008, material: {poissons_ratio: " + row.text("nu") +
                           "}}\nrun: {mode: dynamic, duration_s: 2}\n",
                       4);
    expect_near(found_m, {row.number("tip_ux_m"), row.number("tip_uy_m"), 0.0}, 0.01);
  }
}

TEST(Reference, CooksMembraneConvergesToHalfAPerCent) {
  const ReferenceRow row = read_reference("r2_cook").at(3);
  ASSERT_EQ(row.text("nu"), "0.499");
  const Eigen::Vector3d found_m = displacement_m("cook", "body: {element_size_m: 0.004}\n");
  expect_near(found_m, {row.number("mid_right_ux_m"), row.number("mid_right_uy_m"), 0.0}, 0.005);
}

TEST(Reference, CooksMembraneShears) {
  for (const ReferenceRow& row : read_reference("r2_cook")) {
    if (row.text("law") != "iso") continue;
    const bool plane_strain = row.text("faces_z") == "plane_strain";
    SCOPED_TRACE(row.text("faces_z") + " " + row.text("nu") + " " + row.text("traction_y_Pa"));
    const Eigen::Vector3d found_m =
        displacement_m(plane_strain ? "cook_plane_strain" : "cook",
                       "body: {material: {poissons_ratio: " + row.text("nu") +
                           "}}\nloads: [{box: {min_m: [0.047999, -1, -1], max_m: [1, 1, 1]}, traction_pa: [0, " +
                           row.text("traction_y_Pa") + ", 0]}]\n");
    expect_near(found_m, {row.number("mid_right_ux_m"), row.number("mid_right_uy_m"), 0.0}, 0.01);
    if (plane_strain) {
      EXPECT_LT(std::abs(found_m.z()), 1e-12);
    }
  }
}

// The hanging bar with the reference's cable, every point of which is the mean over a cube of 6 mm.
Eigen::Vector3d hanging_bar_displacement_m(const ReferenceRow& row, const std::string& model,
                                           const std::string& command) {
  std::string points = "[0.007, 0, 0], ";
  for (int i = 1; i <= 12; ++i) points += "[0.007, " + std::to_string(-0.01 * i) + ", 0], ";
  return displacement_m("cable_bar",
                        "body: {element_size_m: 0.009, material: {poissons_ratio: " + row.text("nu") +
                            "}}\ncables: [{name: cable, spread_box_m: 0.006, points_m: [" + points +
                            "[0.007, -0.127, 0]], " + model + "}]\nrun: {commands: [{cable: " + command + "}]}\n",
                        15);
}

bool worth_a_run(const ReferenceRow& row) { return row.text("nu") == "0.499" && row.text("alpha") != "0.85"; }

TEST(Reference, HangingBarFollowsItsSlidingCable) {
  for (const ReferenceRow& row : read_reference("r5_cable_length")) {
    if (!worth_a_run(row)) continue;
    SCOPED_TRACE(row.text("alpha"));
    expect_near(hanging_bar_displacement_m(row, "compliance_m_n: 0", row.text("alpha")),
                {row.number("tip_ux_m"), row.number("tip_uy_m"), 0.0}, 0.02);
  }
}

TEST(Reference, HangingBarFollowsItsSprings) {
  for (const ReferenceRow& row : read_reference("r5_cable_segment_springs")) {
    if (!worth_a_run(row)) continue;
    SCOPED_TRACE(row.text("alpha"));
    expect_near(hanging_bar_displacement_m(row, "model: springs, stiffness_n_m: 3000", row.text("alpha")),
                {row.number("tip_ux_m"), row.number("tip_uy_m"), 0.0}, 0.02);
  }
}

TEST(Reference, HangingBarFollowsTheTension) {
  for (const ReferenceRow& row : read_reference("r5_cable_tension")) {
    if (row.text("nu") != "0.499") continue;
    SCOPED_TRACE(row.text("T_N"));
    expect_near(hanging_bar_displacement_m(row, "command: tension_n", row.text("T_N")),
                {row.number("tip_ux_m"), row.number("tip_uy_m"), 0.0}, 0.02);
  }
}

}  // namespace
}  // namespace soft_robot_lab
