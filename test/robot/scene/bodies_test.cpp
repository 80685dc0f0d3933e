// SPDX-License-Identifier: BSD-3-Clause
// Materials by region and several bodies, from a scene's file to its simulation.
#include <cmath>

#include <gtest/gtest.h>

#include "scene_files.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/robot/scene/run_scene.h"

namespace soft_robot_lab {
namespace {

// A bar that hangs, without gravity; its outer half is what a test makes of it.
const std::string kHolds = "  fixed: [{box: {min_m: [-1, -1, -1], max_m: [1.0e-6, 1, 1]}}]\n";
const std::string kBody =
    "  element_size_m: 0.02\n  material: {youngs_modulus_pa: 1.0e5, poissons_ratio: 0.3}\n" + kHolds;
const std::string kBar = "{box: {size_m: [0.1, 0.02, 0.02], center_m: [0.05, 0, 0]}}";
const std::string kSheet =
    "{box: {size_m: [0.06, 0.02, 0.004], center_m: [0.07, 0, -0.008]}, name: sheet, material: {youngs_modulus_pa: "
    "1.0e6, poissons_ratio: 0.3, density_kg_m3: 2000}}";
const std::string kLayered = "body:\n  solid: {union: [" + kBar + ", " + kSheet + "]}\n" + kBody;

Scene scene_of(const SceneFolder& folder, const std::string& text) {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  return load_scene(folder.write("scene.yaml", text), options);
}

Scene scene_of(const std::string& text) { return scene_of(SceneFolder(), text); }

Eigen::Vector3d tip_m(const std::string& text) {
  Scene scene = scene_of(text + "markers: [{name: tip, position_m: [0.1, 0, 0]}]\n");
  const RunReport report = run_scene(scene);
  EXPECT_TRUE(report.solve.converged) << report.solve.message;
  return scene.simulation->marker_position(0);
}

void expect_refused(const std::string& text, const std::string& words) {
  try {
    scene_of(text);
    ADD_FAILURE() << "accepted: " << text;
  } catch (const std::exception& error) {
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
  }
}

double volume_m3(const TetMesh& mesh, int region) {
  TetMesh part = mesh;
  std::vector<int> tets;
  for (int tet = 0; tet < mesh.tet_count(); ++tet)
    if (mesh.region_of(tet) == region) tets.push_back(tet);
  part.tets = Eigen::MatrixXi(mesh.tets(Eigen::all, tets));
  return volume(part);
}

TEST(Regions, ASheetInABarIsMeshedAlongItsFacesWithItsMaterial) {
  const Scene scene = scene_of(kLayered);
  const Body& body = scene.simulation->body();
  const TetMesh& mesh = body.mesh();
  ASSERT_EQ(mesh.regions.size(), 2u);
  const int sheet = mesh.regions[1].name == "sheet" ? 1 : 0;
  EXPECT_EQ(mesh.regions[sheet].name, "sheet");
  EXPECT_NEAR(volume_m3(mesh, sheet), 0.06 * 0.02 * 0.004, 1e-12);
  EXPECT_NEAR(volume(mesh), 0.1 * 0.02 * 0.02, 1e-12);
  EXPECT_NEAR(body.node_masses_kg().sum(), 4e-5 * 1070.0 + 4.8e-6 * (2000.0 - 1070.0), 1e-9);
  for (int tet = 0; tet < mesh.tet_count(); ++tet)
    EXPECT_EQ(body.material_of(tet).youngs_modulus_pa, mesh.region_of(tet) == sheet ? 1.0e6 : 1.0e5);
}

TEST(Regions, OfTheBodysOwnMaterialChangeNothingButTheMesh) {
  const std::string same = "body:\n  solid: {union: [" + kBar +
                           ", {box: {size_m: [0.06, 0.02, 0.004], center_m: [0.07, 0, -0.008]}, name: sheet, "
                           "material: {youngs_modulus_pa: 1.0e5, poissons_ratio: 0.3}}]}\n" +
                           kBody;
  const std::string gravity = "gravity_m_s2: [0, 0, -3.0]\n";
  const Eigen::Vector3d plain = tip_m("body:\n  solid: " + kBar + "\n" + kBody + gravity);
  EXPECT_GT(-plain.z(), 0.01);
  EXPECT_LT((tip_m(same + gravity) - plain).norm(), 1e-4);  // of elements of another size
  EXPECT_GT((tip_m(kLayered + gravity) - plain).norm(), 5e-4);
}

TEST(Regions, TheSolidThatIsWrittenLastHasWhatBothClaim) {
  const Scene scene = scene_of(
      "body:\n  solid: {union: [{box: {size_m: [0.1, 0.02, 0.02], center_m: [0.05, 0, 0]}, name: low, material: "
      "{youngs_modulus_pa: 2.0e5}}, {box: {size_m: [0.06, 0.02, 0.02], center_m: [0.03, 0, 0]}, name: high, material: "
      "{youngs_modulus_pa: 3.0e5}}]}\n" +
      kBody);
  const TetMesh& mesh = scene.simulation->body().mesh();
  ASSERT_EQ(mesh.regions.size(), 2u);
  const int high = mesh.regions[0].name == "high" ? 0 : 1;
  EXPECT_NEAR(volume_m3(mesh, high), 2.4e-5, 1e-12);
  EXPECT_NEAR(volume_m3(mesh, 1 - high), 1.6e-5, 1e-12);
}

TEST(Regions, SurfacesKeepTheirNamesBesideThem) {
  const Scene scene = scene_of("body:\n  solid: {difference: [{union: [" + kBar + ", " + kSheet +
                               "]}, {sphere: {radius_m: 0.004, center_m: [0.05, 0, 0.003]}, name: cavity}]}\n" + kBody);
  const TetMesh& mesh = scene.simulation->body().mesh();
  EXPECT_EQ(mesh.surface_names, (std::vector<std::string>{"sheet", "cavity"}));
}

const char* const kTwoTets =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n3 7 \"hard\"\n3 8 \"soft\"\n$EndPhysicalNames\n"
    "$Nodes\n5\n1 0 0 0\n2 0.01 0 0\n3 0 0.01 0\n4 0 0 0.01\n5 0 0 -0.01\n$EndNodes\n"
    "$Elements\n2\n1 4 2 7 1 1 2 3 4\n2 4 2 8 2 1 3 2 5\n$EndElements\n";

TEST(Regions, AreTheVolumeGroupsOfAMeshFile) {
  const SceneFolder folder;
  folder.write("two.msh", kTwoTets);
  const std::string body =
      "body:\n  mesh: two.msh\n  fixed: [{box: {min_m: [-1, -1, -1], max_m: [1, 1, 1.0e-6]}}]\n  material: "
      "{youngs_modulus_pa: 1.0e5}\n";
  const Scene scene =
      scene_of(folder, body + "  regions: [{name: hard, material: {youngs_modulus_pa: 1.0e7, density_kg_m3: 3000}}]\n");
  const Body& loaded = scene.simulation->body();
  for (int tet = 0; tet < 2; ++tet) {
    const bool hard = loaded.mesh().regions[loaded.mesh().region_of(tet)].name == "hard";
    EXPECT_EQ(loaded.material_of(tet).youngs_modulus_pa, hard ? 1.0e7 : 1.0e5);
  }
  EXPECT_NEAR(loaded.node_masses_kg().sum(), (3000.0 + 1070.0) * 1e-6 / 6.0, 1e-15);
  EXPECT_THROW(scene_of(folder, body + "  regions: [{name: hart, material: {youngs_modulus_pa: 1.0e7}}]\n"),
               SettingsError);
}

TEST(Regions, WhatCannotBeIsRefused) {
  const std::string box = "{box: {size_m: [0.06, 0.02, 0.004], center_m: [0.07, 0, -0.008]}";
  const auto with = [&](const std::string& part) {
    return "body:\n  solid: {union: [" + kBar + ", " + part + "]}\n" + kBody;
  };
  expect_refused(with(box + ", material: {youngs_modulus_pa: 1.0e6}}"), "without a name");
  expect_refused(with(box + ", name: sheet, material: {youngs_modulus: 1.0e6}}"), "unknown key 'youngs_modulus'");
  expect_refused(with(box + ", name: sheet, material: {}}, " + box + ", name: sheet, material: {}}"), "already");
  expect_refused("body:\n  solid: {difference: [" + kBar +
                     ", {sphere: {radius_m: 0.004, center_m: [0.05, 0, 0]}, "
                     "name: hole, material: {youngs_modulus_pa: 1.0e6}}]}\n" +
                     kBody,
                 "no element of the body lies in 'hole'");
  expect_refused(kLayered + "  regions: [{name: sheet, material: {}}]\n", "give a named solid its `material`");
}

// Two bars beside each other; the second is stiffer and a cable pulls it.
const std::string kSecond =
    "name: second\n    solid: {box: {size_m: [0.1, 0.02, 0.02], center_m: [0.05, 0.05, 0]}}\n    element_size_m: 0.02\n"
    "    material: {youngs_modulus_pa: 2.0e5, poissons_ratio: 0.3}\n"
    "    fixed: [{box: {min_m: [-1, -1, -1], max_m: [1.0e-6, 1, 1]}}]\n";
const std::string kFirst = "body:\n  solid: " + kBar + "\n" + kBody;
const std::string kGravity = "gravity_m_s2: [0, 0, -3.0]\nsolver: {tolerance: 1.0e-8}\n";
const std::string kCable =
    "cables: [{name: left, points_m: [[0, 0.05, 0.006], [0.09, 0.05, 0.006]], plug_radius_m: 0.003}]\n"
    "run: {commands: [{time_s: 0, left: 0.95}]}\n";

std::string alone(std::string second) {
  for (size_t at = second.find("\n    "); at != std::string::npos; at = second.find("\n    ", at + 1))
    second.replace(at, 5, "\n  ");
  return "body:\n" + second.substr(second.find('\n') + 1);
}

TEST(Bodies, OfOneSceneMoveAsEachInItsOwn) {
  Scene both = scene_of(kFirst + "bodies:\n  - " + kSecond + kGravity + kCable +
                        "markers: [{name: a, position_m: [0.1, 0, 0], body: body}, "
                        "{name: b, position_m: [0.1, 0.05, 0], body: second}]\n");
  ASSERT_TRUE(run_scene(both).solve.converged);
  Scene first = scene_of(kFirst + kGravity + "markers: [{name: a, position_m: [0.1, 0, 0]}]\n");
  ASSERT_TRUE(run_scene(first).solve.converged);
  Scene second = scene_of(alone(kSecond) + kGravity + kCable + "markers: [{name: b, position_m: [0.1, 0.05, 0]}]\n");
  ASSERT_TRUE(run_scene(second).solve.converged);
  EXPECT_LT((both.simulation->marker_position(0) - first.simulation->marker_position(0)).norm(), 1e-7);
  EXPECT_LT((both.simulation->marker_position(1) - second.simulation->marker_position(0)).norm(), 1e-7);
  EXPECT_LT(second.simulation->marker_position(0).x(), 0.0975);
  EXPECT_EQ(both.simulation->body().mesh().bodies, (std::vector<std::string>{"body", "second"}));
}

TEST(Bodies, ItemsOfASceneBelongToTheOneThatTheyName) {
  const std::string crossing = kSecond.substr(0, kSecond.find("0.05, 0.05")) + "0.05, 0.01" +
                               kSecond.substr(kSecond.find("0.05, 0.05") + 10);  // half of it inside the first
  const std::string end = "box: {min_m: [0.0999, -1, -1], max_m: [1, 1, 1]}";
  const Scene scene = scene_of(kFirst + "bodies:\n  - " + crossing + "loads: [{" + end +
                               ", body: second, force_n: [1, 0, 0]}]\n"
                               "markers: [{name: m, position_m: [0.05, 0.005, 0], body: second}]\n");
  const Body& body = scene.simulation->body();
  for (int node = 0; node < body.mesh().node_count(); ++node)
    if (!body.dead_loads_n().col(node).isZero(0.0)) {
      EXPECT_EQ(body.body_of_node(node), 1);
    }
  EXPECT_NEAR(body.dead_loads_n().row(0).sum(), 1.0, 1e-12);
  EXPECT_LT((scene.simulation->marker_position(0) - Eigen::Vector3d(0.05, 0.005, 0)).norm(), 1e-12);
}

// A block that is pressed and drawn over another one, with friction; each as `body`, and as the other.
TEST(Bodies, RestAlikeInWhateverOrderTheyAreListed) {
  const std::string of_both = "element_size_m: 0.012, material: {youngs_modulus_pa: 2.0e5, poissons_ratio: 0.45}";
  const std::string lower = "solid: {box: {size_m: [0.03, 0.03, 0.02], center_m: [0, 0, -0.0101]}}, " + of_both +
                            ", fixed: [{box: {min_m: [-1, -1, -1], max_m: [1, 1, -0.02]}}]";
  const std::string upper = "solid: {box: {size_m: [0.02, 0.024, 0.02], center_m: [0.002, 0.001, 0.0101]}}, " +
                            of_both +
                            ", fixed: [{name: lid, box: {min_m: [-1, -1, 0.02], max_m: [1, 1, 1]}, motion: [{time_s: "
                            "0}, {time_s: 1, translation_m: [0, 0, -0.002]}, {time_s: 2, translation_m: [0.003, 0, "
                            "-0.002]}]}]";
  const auto scene = [](const std::string& first, const std::string& second, const std::string& name_of_upper) {
    return "body: {" + first + "}\nbodies: [{name: other, " + second +
           "}]\ncontact: {self: true, friction: 0.4}\nmarkers: [{name: tip, position_m: [0.01, 0.005, 0.001], body: " +
           name_of_upper + "}]\n";
  };
  Scene one = scene_of(scene(lower, upper, "other")), turned = scene_of(scene(upper, lower, "body"));
  const RunReport first = run_scene(one), second = run_scene(turned);
  ASSERT_TRUE(first.solve.converged && second.solve.converged) << first.solve.message << second.solve.message;
  EXPECT_EQ(one.simulation->marker_position(0), turned.simulation->marker_position(0));
  EXPECT_EQ(first.solve.iterations, second.solve.iterations);
  EXPECT_GT(one.simulation->marker_position(0).x(), 0.0102) << "it was drawn along";
}

TEST(Bodies, AChamberMayBeInAnyOfThem) {
  const std::string hollow =
      "name: second\n    solid: {difference: [{box: {size_m: [0.04, 0.02, 0.02], center_m: [0.02, 0.05, 0]}}, "
      "{sphere: {radius_m: 0.006, center_m: [0.02, 0.05, 0]}, name: cavity}]}\n    element_size_m: 0.02\n    " +
      kHolds.substr(2);
  const ActuatorReading air =
      scene_of(kFirst + "bodies:\n  - " + hollow + "chambers: [{name: air, surface: cavity, body: second}]\n")
          .simulation->actuator_state(0);
  EXPECT_EQ(air.surface, "second/cavity");
  const Scene single = scene_of(alone(hollow) + "chambers: [{name: air, surface: cavity}]\n");
  EXPECT_NEAR(*air.initial_volume_m3, *single.simulation->actuator_state(0).initial_volume_m3, 1e-15);
  EXPECT_NEAR(*air.initial_volume_m3, 4.0 / 3.0 * M_PI * std::pow(0.006, 3), 5e-8);
}

TEST(Bodies, WhatCannotBeIsRefused) {
  const std::string bodies = kFirst + "bodies:\n  - ";
  expect_refused(bodies + kSecond + "  - " + kSecond, "two bodies are named 'second'");
  expect_refused(bodies + "name: body" + kSecond.substr(kSecond.find('\n')), "two bodies are named 'body'");
  expect_refused(bodies + kSecond + "    element: linear\n", "unknown key 'element'");
  expect_refused(bodies + kSecond + "markers: [{name: m, position_m: [0, 0, 0], body: third}]\n",
                 "'third' is not one of body, second");
  expect_refused(bodies + kSecond + "fidelity: {tolerance_m: 0.001}\n", "fidelity chooses the mesh of one body");
}

}  // namespace
}  // namespace soft_robot_lab
