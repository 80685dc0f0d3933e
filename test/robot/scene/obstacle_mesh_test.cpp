// SPDX-License-Identifier: BSD-3-Clause
// Obstacles from files of meshes, in a scene.
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "mechanics/body/free_obstacles.h"
#include "mechanics/body/gap.h"
#include "mechanics/body/mesh_solid.h"
#include "mechanics/contact/mesh_shapes.h"
#include "scene_files.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/robot/scene/run_scene.h"

namespace soft_robot_lab {
namespace {

using Eigen::Vector3d;

std::string stl_text(const Triangles& surface) {
  std::ostringstream text;
  text.precision(17);
  text << "solid thing\n";
  for (const auto& t : surface.triangles.colwise()) {
    text << "facet normal 0 0 0\nouter loop\n";
    for (const int vertex : t) text << "vertex " << surface.vertices_m.col(vertex).transpose() << "\n";
    text << "endloop\nendfacet\n";
  }
  return text.str() + "endsolid thing\n";
}

std::string obj_text(const Triangles& surface) {
  std::ostringstream text;
  text.precision(17);
  text << "# a thing\nmtllib thing.mtl\no thing\n";
  for (const auto& at : surface.vertices_m.colwise()) text << "v " << at.transpose() << "\n";
  for (const auto& t : surface.triangles.colwise())
    text << "f " << t[0] + 1 << "/1/1 " << t[1] + 1 << "//2 " << t[2] - surface.vertices_m.cols() << "\n";
  return text.str();
}

Triangles in_mm(Triangles surface) {
  surface.vertices_m *= 1e3;
  return surface;
}

Scene load(const SceneFolder& folder, const std::string& obstacles) {
  SceneOptions options;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  options.actuator_factory = make_actuator;
  return load_scene(folder.write("scene.yaml", "include: bar.yaml\ncontact: {obstacles: [" + obstacles + "]}\n"),
                    options);
}

const Obstacle& first(const Scene& scene) { return scene.simulation->body().obstacles()[0]; }

std::string why_not(const SceneFolder& folder, const std::string& obstacles) {
  try {
    load(folder, obstacles);
  } catch (const SettingsError& error) {
    return error.what();
  }
  return "";
}

TEST(ObstacleMesh, OfEachFormatStandsWhereItsKeysPutIt) {
  const SceneFolder folder;
  const Triangles box = box_triangles({0.01, 0, 0}, {0.02, 0.03, 0.04});
  folder.write("things/box.stl", stl_text(in_mm(box)));
  folder.write("things/box.OBJ", obj_text(box));
  for (const char* file : {"mesh: things/box.stl, scale: 0.001", "mesh: things/box.OBJ"}) {
    const Scene scene = load(folder, std::string("{name: thing, ") + file +
                                         ", position_m: [0.05, -0.1, 0], rotation_rad: [0, 0, 1.5707963267948966]}");
    const Obstacle& thing = first(scene);
    EXPECT_LT((center_m(thing.shape) - Vector3d(0.05, -0.09, 0)).norm(), 1e-9) << file;
    EXPECT_NEAR(volume_m3(thing.shape), 2.4e-5, 1e-12) << file;
    EXPECT_NEAR(gap_to(thing.shape, Vector3d(0.0655, -0.09, 0.001)).gap_m, 0.0005, 1e-9) << file;
  }
  // 30 mm long.
  const Scene scene = load(folder, "{name: part, mesh: \"" SOFT_ROBOT_LAB_SOURCE
                                   "/test/data/cylinder.step\", position_m: [0, -0.2, 0], density_kg_m3: 1000}");
  const auto& solid = *std::get<MeshShape>(first(scene).shape).solid;
  const Eigen::Matrix3Xd& vertices_m = solid.surface().vertices_m();
  EXPECT_NEAR((vertices_m.rowwise().maxCoeff() - vertices_m.rowwise().minCoeff()).maxCoeff(), 0.03, 1e-9);
  EXPECT_NEAR(first(scene).mass_kg, 1000 * solid.surface().volume_m3(), 1e-12);
  EXPECT_FALSE(solid.flat());
}

TEST(ObstacleMesh, OfDensityHasTheMassOfItsShape) {
  const SceneFolder folder;
  const Scene scene =
      load(folder, "{name: ball, sphere: {center_m: [0, -0.2, 0], radius_m: 0.01}, density_kg_m3: 2000}");
  EXPECT_NEAR(first(scene).mass_kg, 2000 * 4.0 / 3.0 * M_PI * 1e-6, 1e-9);
  EXPECT_NE(why_not(folder,
                    "{name: ball, sphere: {center_m: [0, -0.2, 0], radius_m: 0.01}, density_kg_m3: 2, "
                    "mass_kg: 1}")
                .find("density_kg_m3"),
            std::string::npos);
  EXPECT_NE(why_not(folder, "{name: floor, plane: {point_m: [0, -0.2, 0], normal: [0, 1, 0]}, density_kg_m3: 2}")
                .find("a plane has no volume"),
            std::string::npos);
}

// Every file is refused with its name, and the scene's line.
TEST(ObstacleMesh, BadFilesAreRefusedByNameWithTheReason) {
  const SceneFolder folder;
  const Triangles box = box_triangles({0, 0, 0}, {0.02, 0.03, 0.04});
  Triangles open = box, inverted = box, mixed = box, doubled = box, cut = box, apart = box;
  open.triangles.conservativeResize(3, 11);
  for (auto t : inverted.triangles.colwise()) std::swap(t[1], t[2]);
  std::swap(mixed.triangles(1, 4), mixed.triangles(2, 4));
  doubled.triangles.conservativeResize(3, 13);
  doubled.triangles.col(12) = doubled.triangles.col(0);
  cut.vertices_m.col(6) = Vector3d(-0.03, -0.04, 0.01);
  const Triangles other = box_triangles({0.1, 0, 0}, {0.02, 0.03, 0.04});
  apart.vertices_m.conservativeResize(3, 16);
  apart.vertices_m.rightCols(8) = other.vertices_m;
  apart.triangles.conservativeResize(3, 24);
  apart.triangles.rightCols(12) = other.triangles.array() + 8;
  const std::vector<std::pair<std::string, std::string>> cases{
      {stl_text(open), "its surface is not closed: the edge at"},
      {stl_text(inverted), "12 of its 12 triangles face inward"},
      {stl_text(mixed), "1 of its 12 triangles face inward"},
      {stl_text(doubled), "a facet stands twice"},
      {stl_text(cut), "cuts itself"},
      {stl_text(apart), "lie apart"},
      {stl_text(box_triangles({0, 0, 0}, {0.1, 0.1, 0.0001})), "walls too thin"},
      {"solid nothing\nendsolid nothing\n", "holds no triangles"},
      {"no mesh", "is no STL file"},
      {"", "is empty"}};
  for (const auto& [text, reason] : cases) {
    folder.write("bad.stl", text);
    const std::string said = why_not(folder, "{name: thing, mesh: bad.stl, position_m: [0, -0.5, 0]}");
    EXPECT_NE(said.find("scene.yaml:2"), std::string::npos) << said;
    EXPECT_NE(said.find("bad.stl: "), std::string::npos) << said;
    EXPECT_NE(said.find(reason), std::string::npos) << said;
  }
  for (const auto& [text, reason] : {std::pair("v 0 0 zero\n", "line 1: 'zero' is not a finite number"),
                                     {"v 0 0 0\nf 1 2 3\n", "line 2: '2' is none of the 1 vertices so far"},
                                     {"v 0 0 0\nf 1 1\n", "line 2: a face has 2 corners"},
                                     {"v 0 0 2e6\n", "line 1: 2000000 is out of range"},
                                     {"call other.obj\n", "line 1: 'call' stands where v or f is expected"},
                                     {"v 0 0 0\n", "holds no triangles"}}) {
    folder.write("bad.obj", text);
    const std::string said = why_not(folder, "{name: thing, mesh: bad.obj}");
    EXPECT_NE(said.find("bad.obj: "), std::string::npos) << said;
    EXPECT_NE(said.find(reason), std::string::npos) << said;
  }
  EXPECT_NE(why_not(folder, "{name: thing, mesh: none.stl}").find("there is no file"), std::string::npos);
  EXPECT_NE(why_not(folder, "{name: thing, mesh: scene.yaml}").find("must end with .stl, .obj, .step or .stp"),
            std::string::npos);
  EXPECT_NE(why_not(folder, "{name: thing, mesh: bad.stl, scale: 0}").find("scale"), std::string::npos);
  EXPECT_NE(why_not(folder, "{name: ball, sphere: {center_m: [0, -1, 0], radius_m: 0.1}, scale: 2}").find("scale"),
            std::string::npos);
}

TEST(ObstacleMesh, HoldsABarInARunAndInItsResult) {
  const SceneFolder folder;
  folder.write("angle.obj", obj_text(l_triangles(0.03, 0.01, 0.04)));
  Scene scene = load(folder, "{name: angle, mesh: angle.obj, position_m: [0.075, -0.0405, -0.02], friction: 0.3}");
  RunReport report = run_scene(scene);
  ASSERT_TRUE(report.solve.converged) << report.solve.message;
  const auto json = nlohmann::json::parse(result_json(scene, report));
  ASSERT_EQ(json["contacts"].size(), 1u);
  EXPECT_EQ(json["contacts"][0]["between"][1], "angle");
  EXPECT_GT(json["contacts"][0]["force_n"][1], 0.01);
}

}  // namespace
}  // namespace soft_robot_lab
