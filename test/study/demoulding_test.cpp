// SPDX-License-Identifier: BSD-3-Clause
#include "study/experiments/demoulding.h"

#include <stdexcept>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "robot/scene/scene_files.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {
namespace {

TetMesh one_tet() {
  TetMesh mesh;
  mesh.nodes_m = Eigen::Matrix3Xd::Zero(3, 4);
  mesh.nodes_m.rightCols(3) = 0.01 * Eigen::Matrix3d::Identity();
  mesh.tets = Eigen::Vector4i(0, 1, 2, 3);
  mesh.faces.resize(3, 0);
  return mesh;
}

TEST(Demoulding, MeasuresTheStretchOfAnEvenPull) {
  const Eigen::Matrix3d f = Eigen::AngleAxisd(1.2, Eigen::Vector3d(1, 2, 3).normalized()) *
                            Eigen::Vector3d(0.5, 0.8, 2.5).asDiagonal() *
                            Eigen::AngleAxisd(0.4, Eigen::Vector3d(2, 0, 1).normalized());
  const TetMesh linear = one_tet(), quadratic = make_quadratic(one_tet());
  for (const TetMesh& mesh : {linear, quadratic}) EXPECT_NEAR(largest_stretch(mesh, f * mesh.nodes_m).ratio, 2.5, 1e-9);
  EXPECT_EQ(largest_stretch(linear, 0.9 * linear.nodes_m).ratio, 1.0) << "nothing is stretched";
}

TEST(Demoulding, FindsWhereAQuadraticElementIsStretchedMost) {
  TetMesh mesh = make_quadratic(one_tet());
  Eigen::Matrix3Xd positions_m = mesh.nodes_m;
  positions_m.row(2).array() += 20.0 * mesh.nodes_m.row(2).array().square();  // F_zz = 1 + 40 z
  const LargestStretch largest = largest_stretch(mesh, positions_m);
  EXPECT_NEAR(largest.at_m.z(), 0.01 * 0.5854101966249685, 1e-9);
  EXPECT_NEAR(largest.ratio, 1.0 + 40.0 * largest.at_m.z(), 1e-9);
}

// A cube of 20 mm on a floor, whose top is lifted at 60 mm/s, and 60 kPa that hold its bottom.
Scene lifted_cube(const SceneFolder& folder, const std::string& more_fixed = "") {
  SceneOptions options;
  options.actuator_factory = make_actuator;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  return load_scene(
      folder.write("cube.yaml",
                   "body:\n  solid: {box: {size_m: [0.02, 0.02, 0.02], center_m: [0, 0, 0.01]}}\n"
                   "  element_size_m: 0.02\n"
                   "  material: {youngs_modulus_pa: 264200, poissons_ratio: 0.499, density_kg_m3: 1070}\n"
                   "  fixed:\n    - {box: {min_m: [-1, -1, 0.019999], max_m: [1, 1, 1]},"
                   " motion: [{time_s: 0}, {time_s: 1, translation_m: [0, 0, 0.06]}]}\n" +
                       more_fixed +
                       "loads: [{box: {min_m: [-1, -1, -1], max_m: [1, 1, 1.0e-6]}, traction_pa: [0, 0, -60000]}]\n"
                       "gravity_m_s2: [0, 0, -9.81]\n"
                       "contact: {friction: 0.5, obstacles: [{name: floor, plane: {point_m: [0, 0, 0], normal: [0, 0, "
                       "1]}}]}\n"),
      options);
}

TEST(Demoulding, LiftsSuctionAndWeight) {
  const SceneFolder folder;
  const Scene scene = lifted_cube(folder);
  const DemouldingCurve curve = pull_out(*scene.simulation, Eigen::Vector3d::UnitZ(), 0.2);
  ASSERT_TRUE(curve.converged) << curve.message;
  ASSERT_EQ(curve.travel_m.size(), 12u);
  EXPECT_NEAR(curve.travel_m.back(), 0.012, 1e-4);
  const double weight_n = 1070 * 9.81 * 8e-6, suction_n = 60000 * 4e-4;
  EXPECT_NEAR(curve.force_n.back(), suction_n + weight_n, 0.01 * suction_n);
  EXPECT_LT(curve.force_n.front(), 0.9 * curve.force_n.back()) << "the floor bears the rest until it is let go";
  // The mean of an even pull by the same stress: mu (l - 1 / l^2) = 60 kPa. The grip keeps its end from narrowing.
  EXPECT_GT(curve.largest.ratio, 1.2);
  EXPECT_LT(curve.largest.ratio, 2.0);
  EXPECT_GE(curve.peak_force_n, curve.force_n.back());
}

TEST(Demoulding, NeedsOneHeldRegion) {
  const SceneFolder folder;
  const Scene scene = lifted_cube(folder, "    - {box: {min_m: [-1, -1, -1], max_m: [1, 1, 1.0e-6]}, axes: [x]}\n");
  EXPECT_THROW(pull_out(*scene.simulation, Eigen::Vector3d::UnitZ(), 0.1), std::invalid_argument);
}

}  // namespace
}  // namespace soft_robot_lab
