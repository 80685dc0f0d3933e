// SPDX-License-Identifier: BSD-3-Clause
// Files in millimetres, sizes that show that somebody wrote millimetres or megapascals, and odd cables.
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "scene_files.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/robot/scene/run_scene.h"
#include "soft_robot_lab/robot/scene/scene.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

SceneOptions with_mesher() {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  return options;
}

Eigen::Vector3d span_m(const Scene& scene) {
  const Eigen::Matrix3Xd& nodes_m = scene.simulation->body().mesh().nodes_m;
  return nodes_m.rowwise().maxCoeff() - nodes_m.rowwise().minCoeff();
}

// A tetrahedron with edges of 40, 50 and 60 along the axes from the origin.
std::string tetrahedron_stl() {
  const std::vector<std::string> corners = {"0 0 0", "40 0 0", "0 50 0", "0 0 60"};
  std::string text = "solid tetrahedron\n";
  for (const auto& side : std::vector<std::vector<size_t>>{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const size_t corner : side) text += "vertex " + corners[corner] + "\n";
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid tetrahedron\n";
}

std::string tetrahedron_vtk() {
  return "# vtk DataFile Version 3.0\none element\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n"
         "0 0 0\n40 0 0\n0 50 0\n0 0 60\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n";
}

std::string body(const std::string& keys) {
  return "body: {" + keys +
         ", element_size_m: 0.02, fixed: [{box: {min_m: [-1, -1, -1], max_m: [1000, 1000, 1.0e-6]}}]}\n";
}

TEST(Sizes, FilesInMillimetresAreScaledToMetres) {
  const SceneFolder folder;
  folder.write("part.stl", tetrahedron_stl());
  folder.write("part.vtk", tetrahedron_vtk());
  const std::string size = "scale: 0.001, ";
  std::vector<std::string> bodies = {size + "solid: {stl: part.stl}",
                                     size + "solid: {translate: {by_m: [0.1, 0, 0], solid: {stl: part.stl}}}"};
  for (const std::string& keys : bodies) {
    SCOPED_TRACE(keys);
    const Scene scene = load_scene(folder.write("scaled.yaml", body(keys)), with_mesher());
    EXPECT_LT((span_m(scene) - Eigen::Vector3d(0.04, 0.05, 0.06)).norm(), 1e-9) << span_m(scene).transpose();
    EXPECT_TRUE(scene.warnings.empty());
    const double start_m = scene.simulation->body().mesh().nodes_m.row(0).minCoeff();
    EXPECT_NEAR(start_m, keys.find("by_m") == std::string::npos ? 0.0 : 0.1, 1e-9) << "a move stays in metres";
  }
  const std::string mesh =
      "body: {mesh: part.vtk, scale: 0.001, fixed: [{box: {min_m: [-1, -1, -1], max_m: [1, 1, "
      "1.0e-6]}}]}\n";
  EXPECT_LT(
      (span_m(load_scene(folder.write("mesh.yaml", mesh), with_mesher())) - Eigen::Vector3d(0.04, 0.05, 0.06)).norm(),
      1e-12);
}

// They know their unit, and yet a part may be wanted smaller. What moves it stays in metres.
TEST(Sizes, StepFilesAreScaledBesideWhatIsInMetres) {
  const SceneFolder folder;
  const std::string step = "{step: \"" SOFT_ROBOT_LAB_SOURCE "/test/data/cylinder.step\"}";  // 30 mm long
  const std::string keys =
      "scale: 0.5, solid: {union: [{box: {size_m: [0.01, 0.01, 0.04], center_m: [0, 0, 0.02]}}, " + step + "]}";
  const Scene scene = load_scene(folder.write("scaled.yaml", body(keys)), with_mesher());
  EXPECT_NEAR(span_m(scene).z(), 0.04, 1e-9);
  EXPECT_NEAR(span_m(scene).x(), 0.01, 2e-4);
}

TEST(Sizes, FurtherBodiesHaveAScaleOfTheirOwn) {
  const SceneFolder folder;
  folder.write("part.vtk", tetrahedron_vtk());
  const std::string further =
      "include: bar.yaml\nbodies: [{name: second, mesh: part.vtk, scale: 0.002, fixed: [{box: "
      "{min_m: [-1, -1, -1], max_m: [1, 1, 1.0e-6]}}]}]\n";
  EXPECT_NEAR(span_m(load_scene(folder.write("two.yaml", further), with_mesher())).z(), 0.12 + 0.01, 1e-9);
}

TEST(Sizes, AScaleWithoutAFileIsRefused) {
  const SceneFolder folder;
  for (const auto& [scale, words] : std::vector<std::pair<std::string, std::string>>{
           {"0.001", "body.scale: multiplies files, and the solid names neither an STL nor a STEP file"},
           {"0", "body.scale: 0 is out of range [0.001, 1000]"}}) {
    try {
      load_scene(folder.write("bad.yaml", "include: bar.yaml\nbody: {scale: " + scale + "}\n"), with_mesher());
      ADD_FAILURE() << "accepted";
    } catch (const SettingsError& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  }
}

struct Implausible {
  std::string text, kind, words;
};

TEST(Sizes, ImplausibleOnesAreWarnedOf) {
  const SceneFolder folder;
  folder.write("part.vtk", tetrahedron_vtk());
  const std::vector<Implausible> table = {
      {"body: {mesh: part.vtk, fixed: [{box: {min_m: [-1, -1, -1], max_m: [99, 99, 1.0e-6]}}]}", "implausible_size",
       "the body is 60 m long, where robots are 0.001 to 2 m: lengths are metres; if its file has millimetres, set "
       "`scale: 0.001`"},
      {"include: bar.yaml\nbody: {material: {model: yeoh, c1_pa: 44}}", "implausible_stiffness",
       "if c1_pa was given in kPa, multiply it by 1000: did you mean body.material.c1_pa: 44000?"},
      {"include: bar.yaml\nbody: {material: {youngs_modulus_pa: 264.2}}", "implausible_stiffness",
       "was given in kPa, multiply it by 1000: did you mean body.material.youngs_modulus_pa: 264200?"},
      {"include: bar.yaml\nbody: {material: {model: mooney_rivlin, c10_pa: 44, c01_pa: 0}}", "implausible_stiffness",
       "did you mean body.material.c10_pa: 44000?"},
      {"include: bar.yaml\nbodies: [{name: second, solid: {sphere: {radius_m: 0.01, center_m: [0, 0.1, 0]}}, "
       "material: {youngs_modulus_pa: 800}, fixed: [{box: {min_m: [-1, 0.1, -1], max_m: [1, 1, 1]}}]}]",
       "implausible_stiffness", "did you mean bodies[0].material.youngs_modulus_pa: 800000?"},
      {"include: bar.yaml\nbody: {material: {density_kg_m3: 1.07}}", "implausible_density",
       "if it was given in g/cm3, multiply it by 1000: did you mean body.material.density_kg_m3: 1070?"},
      {"include: bar.yaml\nbody: {material: {density_kg_m3: 99e4}}", "implausible_density", "density_kg_m3: 990?"},
      {"include: bar.yaml\ngravity_m_s2: [0, 0, -981]", "implausible_gravity",
       "gravity_m_s2 is 981 m/s2 long, 100 times the earth's: it is in metres; did you mean [0, 0, -9.81]?"},
      {"include: bar.yaml\ngravity_m_s2: [0, 9810, 0]", "implausible_gravity", "gravity_m_s2 is 9810 m/s2 long"},
      {"body: {solid: {box: {size_m: [100, 20, 20], center_m: [0, 0, 0]}}, element_size_m: 20, fixed: [{box: {min_m: "
       "[-99, -99, -99], "
       "max_m: [-49, 99, 99]}}]}",
       "implausible_size", "write metres, or put it into `scale: {factor: 0.001, solid: ...}`"},
      {"include: bar.yaml\nmarkers: [{name: tip, position_m: [1, 0, 0]}]", "implausible_stalk",
       "marker tip is 0.9 m off the body, which is 0.10392"},
  };
  for (const Implausible& each : table) {
    SCOPED_TRACE(each.text);
    const Scene scene = load_scene(folder.write("odd.yaml", each.text + "\n"), with_mesher());
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_EQ(scene.warnings[0].kind, each.kind);
    EXPECT_NE(scene.warnings[0].text.find(each.words), std::string::npos) << scene.warnings[0].text;
  }
  for (const std::string text :
       {"", "body: {material: {youngs_modulus_pa: 0.2642, stiffness_ratio: 1}}\n", "gravity_m_s2: [0, 0, 20]\n"})
    EXPECT_TRUE(load_scene(folder.write("meant.yaml", "include: bar.yaml\n" + text), with_mesher()).warnings.empty());
}

void expect_refused(const std::string& file, const std::vector<std::string>& words,
                    const std::string& mesher = SOFT_ROBOT_LAB_MESHER) {
  try {
    SceneOptions options = with_mesher();
    options.mesher = mesher;
    load_scene(file, options);
    ADD_FAILURE() << "accepted";
  } catch (const SettingsError& error) {
    for (const std::string& each : words)
      EXPECT_NE(std::string(error.what()).find(each), std::string::npos) << error.what();
  }
}

// Before it is meshed, as no mesher is there.
TEST(Sizes, MegapascalsAreRefusedAtOnce) {
  const SceneFolder folder;
  const std::string bodies = "bodies: [{name: second, solid: {sphere: {radius_m: 0.01, center_m: [0, 0.1, 0]}}, ";
  const std::vector<std::vector<std::string>> table = {
      {"body: {material: {youngs_modulus_pa: 0.2642}}", "odd.yaml:2: body.material.youngs_modulus_pa: ",
       "Young's modulus is 0.2642 Pa, where silicones have 1000 Pa and more: if youngs_modulus_pa was given in MPa",
       "did you mean body.material.youngs_modulus_pa: 264200? A `stiffness_ratio` beside it says that it is meant"},
      {"body: {material: {model: yeoh, c1_pa: 0.044}}", "multiply it by 1e6: did you mean body.material.c1_pa: 44000?"},
      {"body: {material: {model: mooney_rivlin, c10_pa: 0.01, c01_pa: 0.03}}",
       "did you mean body.material.c01_pa: 30000"},
      {bodies + "material: {youngs_modulus_pa: 0.5}, fixed: [{box: {min_m: [-1, 0.1, -1], max_m: [1, 1, 1]}}]}]",
       "did you mean bodies[0].material.youngs_modulus_pa: 500000?"}};
  for (const std::vector<std::string>& each : table) {
    SCOPED_TRACE(each[0]);
    const std::string file = folder.write("odd.yaml", "include: bar.yaml\n" + each[0] + "\n");
    expect_refused(file, {each.begin() + 1, each.end()}, "/nowhere");
  }
}

TEST(Sizes, OddOnesThatStrainABodyBeyondSenseAreRefused) {
  const SceneFolder folder;
  const std::string soft = "body: {material: {youngs_modulus_pa: 50}}\n", fall = "gravity_m_s2: [-9.81, 0, 0]\n";
  const std::string weight = "loads: [{box: {min_m: [0.0999, -1, -1], max_m: [1, 1, 1]}, force_n: [0.5, 0, 0]}]\n";
  const std::string large =
      "body: {solid: {box: {size_m: [40, 10, 10], center_m: [20, 0, 0]}}, element_size_m: 10, fixed: [{box: {min_m: "
      "[-1, -9, -9], max_m: [1.0e-6, 9, 9]}}]";
  const std::string pressed =
      "body: {solid: {difference: [{box: {size_m: [0.1, 0.02, 0.02], center_m: [0.05, 0, 0]}}, {name: hollow, box: "
      "{size_m: [0.05, 0.01, 0.01], center_m: [0.05, 0, 0]}}]}, fixed: [{box: {min_m: [-1, -1, -1], max_m: [1.0e-6, 1, "
      "1]}}], material: {youngs_modulus_pa: 500}}\nchambers: [{name: "
      "air, surface: hollow, command: gauge_pressure, max_gauge_pressure_pa: 9000}]\nrun: {commands: [{air: 2000}]}\n";
  const std::string lifts = "says that it is meant";
  const std::vector<std::vector<std::string>> table = {
      {"include: bar.yaml\n" + soft + fall,
       "body.material.youngs_modulus_pa: its weight, loads or commands would strain", "the body by 20.",
       ", where robots bear 2: Young's modulus is 50 Pa", lifts},
      {"include: bar.yaml\n" + soft + weight, "the body by 5.00097, where robots bear 2", lifts},
      {"include: bar.yaml\ngravity_m_s2: [9810, 0, 0]\n", "odd.yaml:2: gravity_m_s2: its weight", "the body by 3.",
       "did you mean [0, 0, -9.81]?", "`stiffness_ratio: 1` in its `material` " + lifts},
      {large + ", material: {youngs_modulus_pa: 1.0e+5}}\n" + fall, "odd.yaml:1: body: its weight",
       "the body is 40 m long", lifts},
      {pressed, "commands would strain the body by 4, where robots bear 2", lifts},
      {large + "}\ngravity_m_s2: [-20, 0, 0]\n", "the body by 3.", "the body is 40 m long", lifts}};
  for (const std::vector<std::string>& each : table) {
    SCOPED_TRACE(each[0]);
    expect_refused(folder.write("odd.yaml", each[0]), {each.begin() + 1, each.end()});
  }
  for (const std::string& text : {soft + "gravity_m_s2: [0, 0, 0]\n", soft + "gravity_m_s2: [-0.5, 0, 0]\n", fall,
                                  "body: {material: {youngs_modulus_pa: 50, stiffness_ratio: 1}}\n" + fall,
                                  std::string("gravity_m_s2: [981, 0, 0]\n")}) {
    SCOPED_TRACE(text);
    EXPECT_NO_THROW(load_scene(folder.write("borne.yaml", "include: bar.yaml\n" + text), with_mesher()));
  }
}

// Whatever is commanded.
TEST(Sizes, WhatCannotMoveIsWarnedOf) {
  const SceneFolder folder;
  const auto warnings = [&](const std::string& boxes) {
    const std::string text = "include: bar.yaml\nbody: {fixed: [" + boxes + "]}\n";
    return load_scene(folder.write("held.yaml", text), with_mesher()).warnings;
  };
  const std::string left = "{box: {min_m: [-1, -1, -1], max_m: [1.0e-6, 1, 1]}",
                    right = "{box: {min_m: [0.0999, -1, -1], max_m: [1, 1, 1]}";
  const std::vector<SolveWarning> all = warnings("{box: {min_m: [-1, -1, -1], max_m: [1, 1, 1]}}");
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].kind, "nothing_moves");
  EXPECT_NE(all[0].text.find("all nodes are held, so nothing can move"), std::string::npos) << all[0].text;
  const std::vector<SolveWarning> both = warnings(left + "}, " + right + "}");
  ASSERT_EQ(both.size(), 1u);
  EXPECT_EQ(both[0].kind, "held_marker");
  EXPECT_NE(both[0].text.find("marker tip lies where the body is held, and cannot move"), std::string::npos);
  EXPECT_TRUE(warnings(left + "}").empty());
  EXPECT_TRUE(warnings(left + "}, " + right + ", axes: [x, y]}").empty()) << "it moves along z";
  EXPECT_TRUE(
      warnings(left + "}, " + right + ", motion: [{time_s: 0}, {time_s: 1, translation_m: [0.01, 0, 0]}]}").empty());
}

// Every solver comes to a wrong shape there, and calls it converged.
TEST(Sizes, LinearElementsThatLockAreWarnedOf) {
  const SceneFolder folder;
  const auto warnings = [&](const std::string& changes) {
    return load_scene(folder.write("linear.yaml", "include: bar.yaml\nbody: {" + changes + "}\n"), with_mesher())
        .warnings;
  };
  for (const std::string ratio : {"0.4", "0.4999"}) {
    const std::vector<SolveWarning> seen = warnings("element: linear, material: {poissons_ratio: " + ratio + "}");
    ASSERT_EQ(seen.size(), 1u) << ratio;
    EXPECT_EQ(seen[0].kind, "locking_elements");
    EXPECT_DOUBLE_EQ(seen[0].size, std::stod(ratio));
    EXPECT_NE(seen[0].text.find("set body.element to quadratic"), std::string::npos) << seen[0].text;
  }
  for (const std::string changes : {"element: linear, material: {poissons_ratio: 0.3}", "element: quadratic",
                                    "element: linear, linear_volume: vertex_averaged"})
    EXPECT_TRUE(warnings(changes).empty()) << changes;
}

// The silicone bends around a cable that has no points in it, and snaps over a plug on its skin.
TEST(Sizes, CablesThatAreSeldomMeantSoAreWarnedOf) {
  const SceneFolder folder;
  const auto warnings = [&](const std::string& path) {
    const std::string text = "include: bar.yaml\ncables: [{name: left, plug_radius_m: 0.002, " + path + "}]\n";
    return load_scene(folder.write("pulled.yaml", text), with_mesher()).warnings;
  };
  const std::string straight = "points_m: [[0.005, 0, 0.005], [0.095, 0, 0.005]]";
  const std::vector<std::vector<std::string>> table = {
      {straight, "straight_in_silicone", "cable left is straight for 90 mm of silicone after its point 0"},
      {"path_m: [[0.095, 0, 0.005], [0, 0, 0.005]]", "cable_back_to_front",
       "cable left ends at (0, 0, 0.005) m, where the body is held, and starts 0.095"},
      {"points_m: [[0.095, 0, 0.005], [0.005, 0, 0.005]], via_points: given", "cable_back_to_front",
       "points_m goes from the drive, at the clamp, to the plug; turn its order round"},
      {"path_m: [[0.005, 0, 0.005], [0.1, 0, 0.005]]", "plug_on_skin",
       "the plug of cable left lies on the skin at (0.1, 0, 0.005) m"}};
  for (const auto& each : table) {
    const std::vector<SolveWarning> seen = warnings(each[0]);
    ASSERT_EQ(seen.size(), 1u) << each[0];
    EXPECT_EQ(seen[0].kind, each[1]);
    EXPECT_NE(seen[0].text.find(each[2]), std::string::npos) << seen[0].text;
  }
  for (const std::string& path :
       {straight + ", via_points: per_element", straight + ", via_points: given",
        std::string("path_m: [[0.005, 0, 0.005], [0.095, 0, 0.005]]"),
        std::string("drive_points_m: [[0.12, 0, 0]], path_m: [[0.095, 0, 0.005], [0, 0, 0.005]]"),
        std::string("points_m: [[0.005, 0, 0.005], [0.025, 0, 0.005]]")})
    EXPECT_TRUE(warnings(path).empty()) << path;
}

TEST(Sizes, WarningsReachTheReportOfARun) {
  const SceneFolder folder;
  Scene scene = load_scene(
      folder.write("odd.yaml", "include: bar.yaml\nmarkers: [{name: tip, position_m: [1, 0, 0]}]\n"), with_mesher());
  const RunReport report = run_scene(scene);
  ASSERT_EQ(report.solve.warnings.size(), 1u);
  EXPECT_EQ(report.solve.warnings[0].kind, "implausible_stalk");
}

// An interrupt ends what follows the warnings, so that they came first. What was not found for it is not kept.
TEST(Sizes, WarningsComeBeforeAMeshIsJudgedOrAModelTrained) {
  const SceneFolder folder;
  const std::string odd = "include: bar.yaml\ngravity_m_s2: [0, -60, 0]\n";
  for (const std::string& more :
       {std::string("solver: {method: reduced, commands: {left: [0.9, 1], right: [0.9, 1]}}\n"),
        std::string("fidelity: {tolerance_m: 1, max_nodes: 300}\n")}) {
    SceneOptions options = with_mesher();
    options.cache_folder = folder.path("cache");
    std::vector<SolveWarning> seen;
    options.reduced = ReducedUse::trained;
    options.on_warnings = [&](const auto& warnings) { seen = warnings; };
    options.interrupt = [&] { return !seen.empty(); };
    std::string end = "loaded";
    try {
      load_scene(folder.write("odd.yaml", odd + more), options);
    } catch (const std::exception& interrupted) {
      end = interrupted.what();
    }
    EXPECT_EQ(end, "loading was interrupted") << more;
    ASSERT_FALSE(seen.empty()) << more;
    EXPECT_EQ(seen[0].kind, "implausible_gravity");
    for (const auto& kept : std::filesystem::directory_iterator(options.cache_folder))
      EXPECT_EQ(kept.path().extension(), ".msh") << more;
  }
}

// Before anything is meshed, or the mesher would run into its limit of time.
TEST(Sizes, ASolidTooLargeToMeshIsAskedForItsUnit) {
  const SceneFolder folder;
  folder.write("part.stl", tetrahedron_stl());
  try {
    load_scene(folder.write("large.yaml", body("solid: {stl: part.stl}")), with_mesher());
    ADD_FAILURE() << "accepted";
  } catch (const SettingsError& error) {
    EXPECT_NE(std::string(error.what()).find("millimetres? `scale: 0.001`"), std::string::npos) << error.what();
  }
  try {
    load_scene(folder.write("large.yaml", body("solid: {box: {size_m: [100, 20, 20], center_m: [0, 0, 0]}}")),
               with_mesher());
    ADD_FAILURE() << "accepted";
  } catch (const SettingsError& error) {
    EXPECT_NE(std::string(error.what()).find("a solid of 40000 m3 millimetres? write metres, or put it into"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace soft_robot_lab
