// SPDX-License-Identifier: BSD-3-Clause
// Shelves for sheaths, against closed forms; solids by the real mesher.
#include "robot/casting/shelves.h"

#include <gtest/gtest.h>

#include "robot/casting/check_casting.h"
#include "robot/casting/extraction.h"
#include "robot/casting/inside_solid.h"
#include "robot/design/surface_file.h"
#include "shapes.h"

namespace soft_robot_lab {
namespace {

using Eigen::Vector3d;

const Vector3d kUp = Vector3d::UnitZ();

Solid solid_of(const std::string& yaml) { return read_solid(YamlNode::parse(yaml, "solid")); }

Surface meshed(const Solid& solid) {
  SurfaceRequest request;
  request.solid = solid;
  request.largest_edge_m = 0.01;
  request.circle_segments = 24;
  request.smallest_edge_m = 0.0003;
  MesherOptions options;
  options.program = SOFT_ROBOT_LAB_MESHER;
  return read_off(surface_file_for(request, options));
}

bool leaves_upwards(const Surface& surface) { return verify_extraction(CastShape(surface), kUp).passed; }

// Two blocks of 30 x 20 x 20 mm on one plate, a gap between them; z is up.
std::string blocks(double gap_m) {
  const std::string apart = std::to_string(0.015 + gap_m / 2);
  return "{union: [{box: {size_m: [0.03, 0.02, 0.02], center_m: [-" + apart +
         ", 0, 0.01]}}, {box: {size_m: [0.03, 0.02, 0.02], center_m: [" + apart +
         ", 0, 0.01]}}, {box: {size_m: [0.04, 0.004, 0.02], center_m: [0, 0.008, 0.01]}}]}";
}

const SheathPath kStraight{"left", {{-0.04, 0, 0.01}, {0, 0, 0.01}, {0.04, 0, 0.01}}, 0.001};

TEST(SheathPieces, GoFromSkinToSkinAndAcrossNarrowGaps) {
  const Surface narrow = meshed(solid_of(blocks(0.004)));
  const std::vector<SheathPiece> one = sheath_pieces(RayTree(narrow), {kStraight}, 0.005);
  ASSERT_EQ(one.size(), 1u);
  EXPECT_NEAR(one[0].length_m(), 0.064, 1e-6);
  EXPECT_NEAR(one[0].in_teeth_m, 0.004, 1e-6);
  EXPECT_EQ(one[0].points_m.size(), 2u) << "a point between alike directions is no bend";
  const Surface wide = meshed(solid_of(blocks(0.006)));
  const std::vector<SheathPiece> two = sheath_pieces(RayTree(wide), {kStraight}, 0.005);
  ASSERT_EQ(two.size(), 2u);
  for (const SheathPiece& piece : two) EXPECT_NEAR(piece.length_m(), 0.03, 1e-6);
}

TEST(SheathPieces, EndWhereTheCableIsAnchored) {
  const SheathPath path{"left", {{-0.04, 0, 0.01}, {-0.01, 0, 0.01}}, 0.001};
  const Surface surface = meshed(solid_of(blocks(0.004)));
  const std::vector<SheathPiece> pieces = sheath_pieces(RayTree(surface), {path}, 0.005);
  ASSERT_EQ(pieces.size(), 1u);
  EXPECT_NEAR(pieces[0].points_m[1].x(), -0.01, 1e-9);
  EXPECT_NEAR(pieces[0].swept_m[1].x(), -0.01, 1e-9) << "inside nothing is swept further";
  EXPECT_NEAR(pieces[0].swept_m[0].x(), -0.032 - 0.0015, 1e-6);
}

TEST(Shelves, LetAStraightSheathOut) {
  const Solid robot = solid_of("{box: {size_m: [0.06, 0.02, 0.02], center_m: [0, 0, 0.01]}}");
  const std::vector<SheathPiece> pieces = sheath_pieces(RayTree(meshed(robot)), {kStraight}, 0.005);
  const std::string tunnel = "{difference: [" + to_yaml(robot) +
                             ", {cylinder: {start_m: [-0.04, 0, 0.01], end_m: [0.04, 0, 0.01], radius_m: 0.001}}]}";
  EXPECT_FALSE(leaves_upwards(meshed(solid_of(tunnel))));
  const Surface shelved = meshed(less_swept_sheaths(robot, pieces, kUp, {-0.001, 0.02}, 0));
  EXPECT_TRUE(leaves_upwards(shelved));
  EXPECT_NEAR(shelved.volume_m3(), 0.06 * (0.02 * 0.02 - 0.002 * 0.01 - kPi / 2 * 1e-6), 2e-9);
}

TEST(Shelves, AreAsWideAsTheirSeatAndCutUpThroughTheMouldsTeeth) {
  const Solid robot = solid_of(blocks(0.004));
  const std::vector<SheathPiece> pieces = sheath_pieces(RayTree(meshed(robot)), {kStraight}, 0.005);
  const MouldHeights heights{-0.001, 0.02};
  const Solid cast = cast_on_shelves(robot, pieces, kUp, heights, 0.0001);
  const auto filled = [&](double x, double y, double z) { return contains(cast, {x, y, z}); };
  EXPECT_TRUE(filled(0.015, 0, 0.01)) << "the sheath's place";
  EXPECT_TRUE(filled(0.015, 0, 0.00895)) << "the seat's lowest line is 1.1 mm below";
  EXPECT_FALSE(filled(0.015, 0, 0.00885));
  EXPECT_FALSE(filled(0.015, 0.00105, 0.009)) << "the shelf's edge";
  EXPECT_TRUE(filled(0.015, 0.00115, 0.009)) << "silicone beside it";
  EXPECT_TRUE(filled(0, 0, 0.0199)) << "the slot through the tooth";
  EXPECT_FALSE(filled(0, 0, 0.0088)) << "the tooth below its seat";
  EXPECT_FALSE(filled(0, 0.0015, 0.015)) << "the tooth beside its slot";
  EXPECT_NEAR(flash_m3(pieces, kUp, heights, 0.0001), 0.004 * (0.0022 * 0.01 - kPi / 2 * 0.0011 * 0.0011), 1e-12);
}

TEST(Shelves, FollowABend) {
  const SheathPath path{"left", {{-0.04, 0, 0.01}, {0, 0, 0.01}, {0.01, -0.02, 0.008}}, 0.001};
  const Solid robot = solid_of("{box: {size_m: [0.06, 0.02, 0.02], center_m: [0, 0, 0.01]}}");
  const std::vector<SheathPiece> pieces = sheath_pieces(RayTree(meshed(robot)), {path}, 0.005);
  EXPECT_TRUE(leaves_upwards(meshed(less_swept_sheaths(robot, pieces, kUp, {-0.001, 0.02}, 0.0001))));
}

CastRobot with_sheaths(const std::vector<SheathPath>& paths) {
  CastRobot robot;
  robot.surface = box({0.06, 0.04, 0.02}).surface();
  robot.sheaths = paths;
  return robot;
}

CastingTest shelves_test_of(const std::vector<SheathPath>& paths) {
  CastingSettings settings;
  settings.direction = kUp;
  settings.sheath.shelf = true;
  return check_casting(with_sheaths(paths), settings).test("shelves");
}

TEST(Shelves, AreRefusedWhereTwoSheathsLieAboveEachOtherAndBothAreNamed) {
  const SheathPath above{"tip", {{-0.04, 0.0015, 0.015}, {0.04, 0.0015, 0.015}}, 0.001};
  const SheathPath across{"side", {{0.01, -0.03, 0.015}, {0.01, 0.03, 0.015}}, 0.001};
  const SheathPath beside{"right", {{-0.04, 0.005, 0.015}, {0.04, 0.005, 0.015}}, 0.001};
  for (const SheathPath& other : {above, across}) {
    const CastingTest test = shelves_test_of({kStraight, other});
    EXPECT_FALSE(test.passed);
    EXPECT_NE(test.why.find("left"), std::string::npos) << test.why;
    EXPECT_NE(test.why.find(other.name), std::string::npos) << test.why;
  }
  const CastingTest test = shelves_test_of({kStraight, beside});
  EXPECT_TRUE(test.passed) << test.why;
  EXPECT_NEAR(test.numbers[0].second, 0.003, 1e-12);
}

TEST(Shelves, AreRefusedForASheathThatStands) {
  const CastingTest test = shelves_test_of({{"left", {{0, 0, -0.01}, {0.001, 0, 0.03}}, 0.001}});
  EXPECT_FALSE(test.passed);
  EXPECT_NE(test.why.find("upright"), std::string::npos) << test.why;
}

TEST(InsideSolid, AgreesWithClosedFormsOfEachShape) {
  const auto inside = [](const std::string& yaml, const Vector3d& p) { return contains(solid_of(yaml), p); };
  const std::string cone = "{cone: {start_m: [0, 0, 0], end_m: [0, 0, 2], radius_m: 1, end_radius_m: 0}}";
  EXPECT_TRUE(inside(cone, {0.49, 0, 1}));
  EXPECT_FALSE(inside(cone, {0.51, 0, 1}));
  EXPECT_FALSE(inside(cone, {0, 0, -0.01}));
  const std::string prism = "{extrude: {polygon_m: [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]], z_m: [0, 1]}}";
  EXPECT_TRUE(inside(prism, {0.9, 1.9, 0.5}));
  EXPECT_FALSE(inside(prism, {1.1, 1.1, 0.5}));
  EXPECT_FALSE(inside(prism, {0.5, 0.5, 1.1}));
  EXPECT_TRUE(inside("{rotate: {solid: " + prism + ", axis: [0, 0, 1], angle_deg: 90}}", {-1.9, 0.9, 0.5}));
  EXPECT_TRUE(inside("{translate: {solid: " + prism + ", by_m: [10, 0, 0]}}", {11.9, 0.9, 0.5}));
  EXPECT_TRUE(inside("{scale: {solid: " + prism + ", factor: 10, center_m: [1, 0, 0]}}", {-8.9, 19, 9}));
  EXPECT_TRUE(inside("{mirror: {solid: " + prism + ", normal: [3, 0, 0]}}", {-1.9, 0.9, 0.5}));
  const std::string array =
      "{array: {solid: " + prism + ", count: 2, by_m: [0, 0, 5], axis: [0, 0, 1], angle_deg: 90}}";
  EXPECT_TRUE(inside(array, {1.9, 0.9, 0.5}));
  EXPECT_TRUE(inside(array, {-0.9, 1.9, 5.5}));
  EXPECT_FALSE(inside(array, {1.9, 0.9, 5.5}));
  EXPECT_FALSE(inside("{difference: [" + prism + ", " + cone + "]}", {0.1, 0.1, 0.5}));
  EXPECT_TRUE(inside("{intersection: [" + prism + ", " + cone + "]}", {0.1, 0.1, 0.5}));
}

}  // namespace
}  // namespace soft_robot_lab
