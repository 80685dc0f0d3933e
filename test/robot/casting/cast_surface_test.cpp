// SPDX-License-Identifier: BSD-3-Clause
// Robots judged by their surface, without a mesh for simulations.
#include <sstream>

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "robot/casting/cast_robot.h"
#include "robot/casting/moved_bends.h"
#include "robot/scene/block_beside.h"
#include "robot/scene/scene_files.h"
#include "shapes.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"

namespace soft_robot_lab {
namespace {

const std::string kBlock =
    "body:\n"
    "  solid: {difference: [{box: {size_m: [0.04, 0.03, 0.02], center_m: [0, 0, 0.01]}},"
    " {cylinder: {start_m: [0, 0, -0.01], end_m: [0, 0, 0.03], radius_m: 0.006}}]}\n"
    "  material: {youngs_modulus_pa: 100000, poissons_ratio: 0.49, density_kg_m3: 1100}\n"
    "  fixed: [{box: {min_m: [-1, -1, -1], max_m: [1, 1, 0.001]}}]\n";
const std::string kSize = "  element_size_m: ";

SceneOptions options() {
  SceneOptions options;
  options.actuator_factory = make_actuator;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  return options;
}

std::string refusal(const std::string& text) {
  const SceneFolder folder;
  try {
    load_cast_surface(folder.write("robot.yaml", text), options());
    return "";
  } catch (const SettingsError& error) {
    return error.what();
  }
}

TEST(CastSurface, GivesTheVerdictOfAMeshedRobot) {
  const SceneFolder folder;
  const CastingVerdict whole =
      check_casting(load_cast_robot(folder.write("robot.yaml", kBlock + kSize + "0.02\n"), options()));
  const std::string fine = folder.write("fine.yaml", kBlock + kSize + "1.0e-6\n");
  EXPECT_THROW(load_cast_robot(fine, options()), SettingsError) << "far too many elements";
  const CastRobotFile file = load_cast_surface(fine, options());
  EXPECT_EQ(file.robot.youngs_modulus_pa, 100000);
  EXPECT_EQ(file.robot.density_kg_m3, 1100);
  const CastingVerdict alone = check_casting(file);
  EXPECT_EQ(alone.castable, whole.castable);
  ASSERT_EQ(alone.tests.size(), whole.tests.size());
  for (size_t i = 0; i + 1 < alone.tests.size(); ++i) EXPECT_EQ(alone.tests[i].numbers, whole.tests[i].numbers);
  EXPECT_EQ(alone.tests.back().name, "mesh_quality");
  EXPECT_FALSE(std::isfinite(alone.tests.back().numbers[0].second));
}

// A cable beside a bar's middle bends it to a circle, but for its ends.
TEST(CastRobot, KnowsHowItsSheathsBendInUse) {
  const SceneFolder folder;
  const std::string bar =
      folder.write("robot.yaml",
                   "body:\n"
                   "  solid: {box: {size_m: [0.1, 0.02, 0.02], center_m: [0.05, 0, 0]}}\n"
                   "  element_size_m: 0.01\n"
                   "  material: {youngs_modulus_pa: 264200, poissons_ratio: 0.499}\n"
                   "  fixed: [{box: {min_m: [-1, -1, -1], max_m: [1.0e-6, 1, 1]}}]\n"
                   "cables:\n"
                   "  - {name: side, points_m: [[0, 0.005, 0], [0.05, 0.005, 0], [0.09, 0.005, 0]],"
                   " via_points: per_element, min_contraction: 0.9}\n"
                   "  - {name: middle, points_m: [[0, 0, 0], [0.09, 0, 0]], min_contraction: 0.95}\n");
  const WorstAlong bend = load_cast_robot_in_use(bar, options()).robot.moved_bend;
  EXPECT_EQ(bend.other, "side") << "the other one leaves the bar straight";
  const Scene scene = load_scene(bar, options());
  Simulation& simulation = *scene.simulation;
  simulation.set_command("side", 0.9);
  ASSERT_TRUE(simulation.solve_equilibrium().converged);
  SheathPath path{"side", simulation.actuator_state(0).path_m, 0.001};
  const double circle_m = tightest_arc(path, 0.03).worst_m;
  EXPECT_LT(bend.worst_m, circle_m);
  EXPECT_GT(bend.worst_m, 0.85 * circle_m);
}

// Its bends in use are not known then, and the rest is judged all the same.
TEST(CastRobot, MayHaveActuatorsWithoutAnEquilibrium) {
  const SceneFolder folder;
  const std::string springs =
      "cables: {left: {model: springs, integration: explicit, coupling: pseudo_inverse, stiffness_n_m: 1000}, "
      "right: {model: springs, integration: explicit, coupling: pseudo_inverse, stiffness_n_m: 1000}}\n";
  const std::string robot = folder.write("robot.yaml", "include: bar.yaml\n" + springs);
  const CastRobotFile file = load_cast_robot_in_use(robot, options());
  EXPECT_FALSE(std::isfinite(file.robot.moved_bend.worst_m));
}

// As a mould of it needs none.
TEST(CastRobot, NeedsNothingThatHoldsIt) {
  const SceneFolder folder;
  const std::string plain =
      "body: {solid: {box: {size_m: [0.02, 0.02, 0.02], center_m: [0, 0, 0]}}, element_size_m: 0.01, material: "
      "{youngs_modulus_pa: 100000, poissons_ratio: 0.4}}\n";
  const CastRobotFile file = load_cast_robot_in_use(folder.write("plain.yaml", plain), options());
  EXPECT_FALSE(std::isfinite(file.robot.moved_bend.worst_m));
  EXPECT_GT(file.robot.mesh_qualities.size(), 0);
  const CastingVerdict verdict = check_casting(file);
  EXPECT_TRUE(verdict.castable);
  EXPECT_EQ(verdict.castable,
            check_casting(load_cast_surface(folder.write("surface.yaml", plain), options())).castable);
}

TEST(TightestArc, IsACirclesRadius) {
  SheathPath path{"left", {}, 0.001};
  EXPECT_FALSE(std::isfinite(tightest_arc(path, 0.003).worst_m));
  for (int i = 0; i <= 100; ++i) path.points_m.emplace_back(0.02 * std::cos(0.01 * i), 0.02 * std::sin(0.01 * i), 0);
  EXPECT_NEAR(tightest_arc(path, 0.003).worst_m, 0.02, 2e-5);
  EXPECT_FALSE(std::isfinite(tightest_arc(path, 0.011).worst_m)) << "shorter than two steps";
}

std::string box_at(double x, double y, const char* rest) {
  return "{box: {center_m: [" + std::to_string(x) + ", " + std::to_string(y) + ", " + rest + "}}";
}

// A plate with 100 feet, less 99 square holes between them: 200 solids.
std::string plate_of_200_solids() {
  std::string feet = "{box: {size_m: [0.21, 0.21, 0.006], center_m: [0.095, 0.095, 0]}}", holes;
  for (int i = 0; i < 100; ++i) {
    const double x = 0.02 * (i % 10), y = 0.02 * (i / 10);
    feet += ", " + box_at(x, y, "-0.006], size_m: [0.006, 0.006, 0.008]");
    if (i < 99) holes += ", " + box_at(x + 0.0085, y + 0.0085, "0], size_m: [0.004, 0.004, 0.02]");
  }
  return "{difference: [{union: [" + feet + "]}" + holes + "]}";
}

TEST(CastSurface, JudgesASolidOf200Solids) {
  const SceneFolder folder;
  const std::string text = "body: {solid: " + plate_of_200_solids() + "}\ncasting: {direction: [0, 0, 1]}\n";
  const CastRobotFile file = load_cast_surface(folder.write("robot.yaml", text), options());
  EXPECT_NEAR(file.robot.surface.volume_m3(), 0.21 * 0.21 * 0.006 + 100 * 36e-6 * 0.007 - 99 * 16e-6 * 0.006, 1e-9);
  const CastingVerdict verdict = check_casting(file);
  EXPECT_TRUE(verdict.castable) << verdict_json(verdict);
}

TEST(CastSurface, RefusesSeveralBodiesAndMaterials) {
  const SceneFolder folder;
  const std::string lid =
      "body: {solid: {difference: [{union: [{box: {size_m: [0.04, 0.03, 0.02], center_m: [0, 0, 0.01]}}, {box: "
      "{size_m: "
      "[0.04, 0.03, 0.01], center_m: [0, 0, 0.025]}, name: lid, material: {youngs_modulus_pa: 200000, poissons_ratio: "
      "0.49, density_kg_m3: 1100}}]}, {cylinder: {start_m: [0, 0, -0.01], end_m: [0, 0, 0.04], radius_m: 0.006}}]}}\n";
  folder.write("block.yaml", kBlock + kSize + "0.02\n");
  for (const std::string& more : {std::string(kBlockBeside), lid}) {
    try {
      load_cast_robot(folder.write("robot.yaml", "include: block.yaml\n" + more), options());
      ADD_FAILURE() << "accepted: " << more;
    } catch (const SettingsError& error) {
      EXPECT_NE(std::string(error.what()).find("casting knows one body of one material, not several"),
                std::string::npos)
          << error.what();
    }
  }
}

// Each box by its lowest corner and its edge in mm.
std::string stl_of_boxes(const std::vector<Eigen::Vector4d>& boxes) {
  std::ostringstream text;
  text << "solid boxes\n";
  for (const Eigen::Vector4d& placed : boxes) {
    const Surface surface = box(Eigen::Vector3d::Constant(std::abs(placed[3]))).surface();
    const std::array<int, 3> order = placed[3] > 0 ? std::array{0, 1, 2} : std::array{0, 2, 1};  // below 0: a hollow
    for (int t = 0; t < surface.triangle_count(); ++t) {
      text << "facet normal 0 0 0\nouter loop\n";
      for (const int i : order) text << "vertex " << (surface.corner(t, i) + placed.head<3>()).transpose() << "\n";
      text << "endloop\nendfacet\n";
    }
  }
  return text.str() + "endsolid boxes\n";
}

TEST(CastSurface, RefusesAnStlThatCrossesItselfAndSaysWhere) {
  const SceneFolder folder;
  const auto error = [&](const std::vector<Eigen::Vector4d>& boxes) -> std::string {
    folder.write("body.stl", stl_of_boxes(boxes));
    try {
      load_cast_surface(folder.write("robot.yaml", "body: {solid: {stl: body.stl}, scale: 0.001}\n"), options());
      return "";
    } catch (const SettingsError& thrown) {
      return thrown.what();
    }
  };
  EXPECT_EQ(error({{0, 0, 0, 20}}), "");
  EXPECT_EQ(error({{0, 0, 0, 20}, {0, 0, 5, -10}}), "") << "a cavity is no crossing";
  const std::string crossing = error({{0, 0, 0, 20}, {12, 8, 11, 15}});
  EXPECT_NE(crossing.find("its surface cuts itself near ("), std::string::npos) << crossing;
}

TEST(CastSurface, RefusesWhatItDoesNotKnow) {
  EXPECT_NE(refusal(kBlock + "castings: {}\n").find("castings: is no block"), std::string::npos);
  EXPECT_NE(refusal(kBlock + "casting: {wal_m: 0.004}\n").find("wal_m"), std::string::npos);
  EXPECT_NE(refusal("body: {mesh: robot.msh}\n").find("has no solid"), std::string::npos);
  EXPECT_NE(refusal(kBlock + "bodies: [{name: other}]\n").find("one body"), std::string::npos);
}

}  // namespace
}  // namespace soft_robot_lab
