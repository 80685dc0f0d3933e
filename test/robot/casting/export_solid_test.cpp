// SPDX-License-Identifier: BSD-3-Clause
// The program export_solid: what it writes is meshed again.
#include <cmath>

#include <gtest/gtest.h>

#include "robot/design/surface_file.h"
#include "robot/casting/surface.h"
#include "read_three_mf.h"
#include "robot/scene/scene_files.h"
#include "run_program.h"

namespace soft_robot_lab {
namespace {

const std::string kBody =
    "body: {solid: {rotate: {axis: [1, 0, 0], angle_deg: 90, solid: {difference: ["
    "{box: {size_m: [0.04, 0.03, 0.02], center_m: [0, 0, 0]}}, "
    "{cylinder: {start_m: [0, 0, -0.1], end_m: [0, 0, 0.1], radius_m: 0.005}}]}}}}\n";
const double kVolume_m3 = 0.04 * 0.03 * 0.02 - M_PI * 25e-6 * 0.02;

Outcome export_to(const SceneFolder& folder, const std::string& file, const std::string& more = "") {
  return run_program(SOFT_ROBOT_LAB_EXPORT_SOLID, folder,
                     folder.write("robot.yaml", kBody) + " --output " + folder.path(file) + more);
}

Surface surface_of(const std::string& solid) {
  SurfaceRequest request;
  request.solid = read_solid(YamlNode::parse(solid, "solid"));
  request.circle_segments = 96;
  MesherOptions options;
  options.program = SOFT_ROBOT_LAB_MESHER;
  return read_off(surface_file_for(request, options));
}

Surface read_again(const SceneFolder& folder, const std::string& kind, const std::string& file) {
  return surface_of("{" + kind + ": " + folder.path(file) + "}");
}

TEST(ExportSolid, WritesStepInMillimetres) {
  const SceneFolder folder;
  ASSERT_EQ(export_to(folder, "out.step").exit_status, 0) << contents(folder.path("err"));
  const Surface surface = read_again(folder, "step", "out.step");
  EXPECT_NEAR(surface.volume_m3() / kVolume_m3, 1, 1e-4);
  EXPECT_NEAR((surface.vertices_m.rowwise().maxCoeff() - Eigen::Vector3d(0.02, 0.01, 0.015)).norm(), 0, 1e-9);
}

TEST(ExportSolid, WritesClosedStlInMillimetres) {
  const SceneFolder folder;
  ASSERT_EQ(export_to(folder, "out.stl", " --largest-edge 0.01").exit_status, 0) << contents(folder.path("err"));
  const Surface surface = read_again(folder, "stl", "out.stl");
  EXPECT_NEAR(surface.volume_m3() / (1e9 * kVolume_m3), 1, 2e-3) << "STL bodies are read in metres";
}

TEST(ExportSolid, WritesClosed3mfInMillimetres) {
  const SceneFolder folder;
  ASSERT_EQ(export_to(folder, "out.3mf", " --largest-edge 0.01").exit_status, 0) << contents(folder.path("err"));
  const Surface surface = read_three_mf(contents(folder.path("out.3mf")));
  EXPECT_NEAR(surface.volume_m3() / (1e9 * kVolume_m3), 1, 2e-3);
  EXPECT_NEAR((surface.vertices_m.rowwise().maxCoeff() - Eigen::Vector3d(20, 10, 15)).norm(), 0, 1e-5);
}

// As others publish them: in millimetres, and in a frame of their own.
TEST(ExportSolid, TurnsMovesAndScalesAnStlBody) {
  const SceneFolder folder;
  ASSERT_EQ(export_to(folder, "out.stl", " --largest-edge 0.01").exit_status, 0) << contents(folder.path("err"));
  const Surface surface = surface_of(
      "{translate: {by_m: [0, 0, 0.1], solid: {scale: {factor: 0.001, solid: {rotate: {axis: [1, 0, 0], angle_deg: "
      "-90, solid: {mirror: {normal: [0, 0, 2], center_m: [0, 0, 15], solid: {stl: " +
      folder.path("out.stl") + "}}}}}}}}}");
  EXPECT_NEAR(surface.volume_m3() / kVolume_m3, 1, 2e-3);
  EXPECT_NEAR((surface.vertices_m.rowwise().maxCoeff() - Eigen::Vector3d(0.02, 0.045, 0.11)).norm(), 0, 1e-8);
  EXPECT_NEAR((surface.vertices_m.rowwise().minCoeff() - Eigen::Vector3d(-0.02, 0.015, 0.09)).norm(), 0, 1e-8);
}

TEST(ExportSolid, RefusesAnArrayOfAnStlBody) {
  const SceneFolder folder;
  ASSERT_EQ(export_to(folder, "out.stl").exit_status, 0) << contents(folder.path("err"));
  EXPECT_THROW(surface_of("{array: {count: 2, by_m: [1, 0, 0], solid: {stl: " + folder.path("out.stl") + "}}}"),
               std::invalid_argument);
}

// Cut one after the other, each takes as long as all before it.
TEST(ExportSolid, CutsManySolidsAwayAtOnce) {
  std::string solid = "{difference: [{box: {size_m: [0.07, 0.07, 0.01], center_m: [0, 0, 0.005]}}";
  for (int i = 0; i < 36; ++i) {
    const std::string at = std::to_string(0.01 * (i % 6) - 0.025) + ", " + std::to_string(0.01 * (i / 6) - 0.025);
    solid += ", {box: {size_m: [0.004, 0.004, 0.008], center_m: [" + at + ", 0.01]}}";
  }
  EXPECT_NEAR(surface_of(solid + "]}").volume_m3(), 0.07 * 0.07 * 0.01 - 36 * 0.004 * 0.004 * 0.004, 1e-13);
}

TEST(ExportSolid, RefusesOtherEndingsAndBadRobots) {
  const SceneFolder folder;
  const Outcome ending = export_to(folder, "out.obj");
  EXPECT_EQ(ending.exit_status, 2);
  EXPECT_NE(ending.err.find(".stl, .3mf or .step"), std::string::npos) << ending.err;
  const Outcome robot =
      run_program(SOFT_ROBOT_LAB_EXPORT_SOLID, folder,
                  folder.write("bad.yaml", "body: {solid: {bx: 1}}") + " --output " + folder.path("x.stl"));
  EXPECT_EQ(robot.exit_status, 2);
  EXPECT_NE(robot.err.find("bad.yaml"), std::string::npos) << robot.err;
}

}  // namespace
}  // namespace soft_robot_lab
