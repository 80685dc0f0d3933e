// SPDX-License-Identifier: BSD-3-Clause
#include "robot/casting/check_casting.h"

#include <functional>
#include <sstream>

#include <gtest/gtest.h>

#include "mechanics/mesh/cable_path.h"
#include "robot/casting/pockets.h"
#include "robot/casting/sheaths.h"
#include "robot/casting/squeeze.h"
#include "robot/design/surface_file.h"
#include "shapes.h"

namespace soft_robot_lab {
namespace {

const Eigen::Vector3d kUp = Eigen::Vector3d::UnitZ();

CastRobot robot_of(const Shape& shape) {
  CastRobot robot;
  robot.surface = shape.surface();
  return robot;
}

std::string failures(const CastingVerdict& verdict) {
  std::string names;
  for (const CastingTest& test : verdict.tests)
    if (!test.passed) names += (names.empty() ? "" : ", ") + test.name;
  return names;
}

double number(const CastingVerdict& verdict, const std::string& test, const std::string& key) {
  for (const auto& [name, value] : verdict.test(test).numbers)
    if (name == key) return value;
  throw std::out_of_range(key);
}

TEST(CheckCasting, PassesABox) {
  const CastingVerdict verdict = check_casting(robot_of(box({0.03, 0.02, 0.01})), {});
  EXPECT_TRUE(verdict.castable) << failures(verdict);
  EXPECT_EQ(failures(verdict), "");
}

TEST(CheckCasting, RefusesAClosedHollowForItsTrappedCore) {
  Shape hollow = box({0.02, 0.02, 0.02}), hole = box({0.01, 0.01, 0.01}, 0.005);
  hole.turn_inside_out();
  hollow.add(hole);
  const CastingVerdict verdict = check_casting(robot_of(hollow), {});
  EXPECT_EQ(failures(verdict), "cavities");
  EXPECT_EQ(verdict.test("cavities").cause, "trapped core");
  EXPECT_NEAR(number(verdict, "cavities", "volume_m3"), 1e-6, 1e-12);
}

// A chamber of our Bubblebot, whose volume, 77.75 ml, is the source's; bore and walls are ours.
Shape tall_cup() { return cup(0.0233, std::sqrt(943.1235e-6 / kPi), 0.0884, 0.006, 128); }

TEST(CheckCasting, RefusesACoreWithoutAirForItsSuction) {
  CastingSettings settings;
  settings.direction = kUp;
  CastingVerdict verdict = check_casting(robot_of(tall_cup()), settings);
  EXPECT_EQ(failures(verdict), "suction");
  EXPECT_NEAR(number(verdict, "suction", "force_n"), 943.1235e-6 * 101325, 0.01 * 95.5);
  EXPECT_NEAR(verdict.test("suction").at_m->z(), 0.0824, 1e-5);
  EXPECT_NE(verdict.test("suction").cause.find("vacuum"), std::string::npos);
  settings.air_holes = true;
  verdict = check_casting(robot_of(tall_cup()), settings);
  EXPECT_TRUE(verdict.castable) << failures(verdict);
}

TEST(CheckCasting, FindsNoPocketWhereABoreGoesThrough) {
  const Surface surface = pipe(0.01, 0.006, 0.03, 64).surface();
  EXPECT_TRUE(find_pockets(RayTree(surface), kUp, 0.0005).pockets.empty());
}

TEST(CheckCasting, CountsNoHoleThroughTheRobotAsPartOfAPocket) {
  // A bore of 12 mm that narrows to 4 mm at half the height: a shoulder of 10 mm depth around a hole.
  const Surface surface =
      revolved({{0.006, 0}, {0.01, 0}, {0.01, 0.02}, {0.002, 0.02}, {0.002, 0.01}, {0.006, 0.01}}, 64).surface();
  const Pockets found = find_pockets(RayTree(surface), kUp, 0.0005);
  ASSERT_EQ(found.pockets.size(), 1u);
  ASSERT_EQ(found.cores.size(), 1u);
  EXPECT_TRUE(found.cores[0].through);
  EXPECT_NEAR(found.cores[0].height_m, 0.01, 0.02 * 0.01);  // its upper part is the slimmer one
  EXPECT_NEAR(found.cores[0].width_m, 0.004, 0.02 * 0.004);
  EXPECT_NEAR(found.pockets[0].roof_area_m2, kPi * (36e-6 - 4e-6), 0.02 * kPi * 32e-6);
}

TEST(CheckCasting, MeasuresTheCoreOfAPocket) {
  const Surface surface = cup(0.01, 0.005, 0.05, 0.004, 64).surface();
  const Pockets found = find_pockets(RayTree(surface), kUp, 0.0005);
  ASSERT_EQ(found.pockets.size(), 1u);
  ASSERT_EQ(found.cores.size(), 1u);
  EXPECT_FALSE(found.cores[0].through);
  EXPECT_NEAR(found.cores[0].height_m, 0.046, 1e-6);
  EXPECT_NEAR(found.cores[0].width_m, 0.01, 0.01 * 0.01);
  EXPECT_NEAR(found.footprint_m2, kPi * 1e-4, 0.01 * kPi * 1e-4);
}

TEST(CheckCasting, MeasuresTheStretchThatAnUndercutNeeds) {
  const Squeeze squeeze = needed_stretch(frustum({0.01, 0.01}, {0.005, 0.005}, 0.02).surface(), kUp);
  EXPECT_NEAR(squeeze.stretch, 2, 0.02);
  EXPECT_EQ(needed_stretch(frustum({0.01, 0.01}, {0.012, 0.012}, 0.02).surface(), kUp).stretch, 1);
}

// A block of 40 x 20 x 20 mm with sheaths along x.
CastRobot with_sheaths(const std::vector<SheathPath>& paths) {
  CastRobot robot = robot_of(box({0.04, 0.02, 0.02}));
  robot.sheaths = paths;
  return robot;
}

TEST(CheckCasting, MeasuresTheSiliconeAroundASheath) {
  const SheathPath path{"left", {{-0.03, 0, 0.0018}, {0.03, 0, 0.0018}}, 0.001};
  EXPECT_TRUE(check_casting(with_sheaths({path}), {}).test("cables").passed);
  CastingSettings settings;
  settings.sheath.wall_m = 0.001;
  const CastingVerdict verdict = check_casting(with_sheaths({path}), settings);
  EXPECT_EQ(failures(verdict), "cables");
  EXPECT_NEAR(number(verdict, "cables", "worst_wall_m"), 0.0008, 1e-7);
}

TEST(CheckCasting, RefusesABendThatKinksTheSheath) {
  // A circle of 10 mm by chords: the arc that fits into them has its radius times the cosine of half a step.
  SheathPath path{"bent", {}, 0.0005};
  for (int i = 0; i <= 12; ++i) {
    const double turn = kPi / 2 * i / 12;
    path.points_m.emplace_back(0.01 * std::cos(turn) - 0.005, 0, 0.005 + 0.01 * std::sin(turn));
  }
  const CastingVerdict verdict = check_casting(with_sheaths({path}), {});
  EXPECT_EQ(failures(verdict), "cables");
  EXPECT_NEAR(number(verdict, "cables", "worst_radius_m"), 0.01, 0.01 * 0.01);
  EXPECT_NE(verdict.test("cables").why.find("kinks"), std::string::npos);
}

// A parabola y = x² / 40 mm: its tightest place is its vertex, with 20 mm; chords of it bend a little more.
TEST(CheckCasting, MeasuresTheBendOfASpline) {
  SheathPath path{"left", points_on_spline({{-0.02, 0.02, 0}, {0, 0, 0}, {0.02, 0.02, 0}}, 5e-5), 0.001};
  const WorstAlong worst = tightest_bend({path});
  EXPECT_NEAR(worst.worst_m, 0.02, 0.02 * 0.03);
  EXPECT_LT((worst.at_m - Eigen::Vector3d(0, 0.01, 0)).norm(), 0.002);
}

TEST(CheckCasting, MeasuresTheLigamentBetweenTwoSheaths) {
  const SheathPath a{"a", {{-0.03, -0.0012, 0.01}, {0.03, -0.0012, 0.01}}, 0.001},
      b{"b", {{-0.03, 0.0012, 0.01}, {0.03, 0.0012, 0.01}}, 0.001};
  const CastingVerdict verdict = check_casting(with_sheaths({a, b}), {});
  EXPECT_EQ(failures(verdict), "ligaments");
  EXPECT_NEAR(number(verdict, "ligaments", "worst_m"), 0.0004, 1e-9);
}

TEST(CheckCasting, WritesNoNumberThatJsonDoesNotKnow) {
  const std::string json = verdict_json(check_casting(robot_of(box({0.03, 0.02, 0.01})), {}));
  EXPECT_EQ(json.find("inf"), std::string::npos);
  EXPECT_NE(json.find("\"castable\": true"), std::string::npos);
}

TEST(CheckCasting, SaysWhyForEachFailure) {
  CastingSettings settings;
  settings.min_thickness_m = 0.05;
  settings.min_angle_deg = 90.5;
  settings.direction = Eigen::Vector3d(1, 1, 1).normalized();
  for (const CastingTest& test : check_casting(robot_of(box({0.03, 0.02, 0.01})), settings).tests)
    EXPECT_EQ(test.passed, test.why.empty()) << test.name;
}

using NormalAt = std::function<Eigen::Vector3d(const Eigen::Vector3d&)>;

Surface meshed(const std::string& solid) {
  SurfaceRequest request;
  request.solid = read_solid(YamlNode::parse(solid, "solid"));
  request.circle_segments = 24;
  MesherOptions options;
  options.program = SOFT_ROBOT_LAB_MESHER;
  return read_off(surface_file_for(request, options));
}

// The largest angle between the normals of round skin and the true ones at its triangles' centres.
double worst_angle_rad(const Surface& surface, const NormalAt& normal_at) {
  double worst = 0.0;
  for (int t = 0; t < surface.triangle_count(); ++t) {
    if (std::abs(surface.normals(2, t)) > 0.9) continue;  // flat ends
    worst = std::max(worst, surface.true_normals.col(t).cross(normal_at(surface.centre(t))).norm());
  }
  return worst;
}

TEST(CheckCasting, KnowsTheNormalsOfWhatFacetsStandFor) {
  const NormalAt of_cylinder = [](const Eigen::Vector3d& at) {
    return Eigen::Vector3d(at.x(), at.y(), 0).normalized();
  };
  const Surface cylinder = meshed("{cylinder: {start_m: [0, 0, 0], end_m: [0, 0, 0.03], radius_m: 0.015}}");
  EXPECT_LT(worst_angle_rad(cylinder, of_cylinder), 1e-6);
  const NormalAt of_cone = [](const Eigen::Vector3d& at) {
    return Eigen::Vector3d(std::cos(0.1) * at.head<2>().normalized().x(), std::cos(0.1) * at.head<2>().normalized().y(),
                           std::sin(0.1));
  };
  const std::string end_radius = std::to_string(0.015 - 0.1 * std::tan(0.1));
  const Surface cone =
      meshed("{cone: {start_m: [0, 0, 0], end_m: [0, 0, 0.1], radius_m: 0.015, end_radius_m: " + end_radius + "}}");
  EXPECT_LT(worst_angle_rad(cone, of_cone), 1e-4);
}

std::string bar(double radius_m, double from_m, double to_m, double x_m = 0, double end_radius_m = 0) {
  std::ostringstream text;
  text << (end_radius_m > 0 ? "{cone: " : "{cylinder: ") << "{start_m: [" << x_m << ", 0, " << from_m << "], end_m: ["
       << x_m << ", 0, " << to_m << "], radius_m: " << radius_m;
  if (end_radius_m > 0) text << ", end_radius_m: " << end_radius_m;
  return text.str() + "}}";
}

struct Holed {
  std::string solid;
  double aspect, through_holes;
};

// The mesher's facets of a round wall share no corners from one height to the next, so that slivers look down.
TEST(CheckCasting, MeasuresTheCoresOfRoundHoles) {
  const std::string block = "{box: {size_m: [0.06, 0.04, 0.05], center_m: [0, 0, 0.025]}}, ";
  const std::string whole = bar(0.018, 0, 0.05) + ", ";
  for (const auto& [solid, aspect, holes] : {
           Holed{whole + bar(0.012, -0.001, 0.051), 50 / 24.0, 1},
           Holed{whole + bar(0.01, -0.001, 0.051, 0.004), 2.5, 1},
           Holed{whole + bar(0.002, -0.001, 0.051), 12.5, 1},
           Holed{whole + bar(0.01, -0.001, 0.045), 2.25, 0},
           Holed{whole + bar(0.012, 0, 0.05, 0, 0.006), 50 / 24.0, 1},
           Holed{bar(0.03, 0, 0.003) + ", " + bar(0.004, -0.001, 0.004), 0.375, 1},
           Holed{block + bar(0.009, -0.001, 0.051), 50 / 18.0, 1},
           Holed{block + bar(0.009, -0.001, 0.051, -0.015) + ", " + bar(0.006, -0.001, 0.051, 0.02), 50 / 12.0, 2},
           Holed{whole + bar(0.012, -0.001, 0.01) + ", " + bar(0.004, 0, 0.051), 5, 1},
       }) {
    CastRobot robot;
    robot.surface = meshed("{difference: [" + solid + "]}");
    CastingSettings settings;
    settings.direction = kUp;
    const CastingVerdict verdict = check_casting(robot, settings);
    EXPECT_NEAR(number(verdict, "aspect", "worst"), aspect, 0.02 * aspect) << solid;
    EXPECT_EQ(number(verdict, "aspect", "through_holes"), holes) << solid;
    EXPECT_EQ(verdict.test("aspect").passed, aspect <= 5) << solid;
    EXPECT_EQ(number(verdict, "suction", "pockets") > 0, holes == 0 || aspect == 5) << solid;
  }
}

TEST(CheckCasting, SaysThatASlimCoreStandsInAHoleThroughTheRobot) {
  const CastingVerdict verdict = check_casting(robot_of(pipe(0.01, 0.002, 0.05, 48)), {});
  EXPECT_EQ(failures(verdict), "aspect");
  EXPECT_NE(verdict.test("aspect").why.find("hole through the robot"), std::string::npos);
}

TEST(CheckCasting, MeasuresASquareHoleAsARoundOne) {
  CastRobot robot;
  robot.surface = meshed(
      "{difference: [{box: {size_m: [0.04, 0.04, 0.05], center_m: [0, 0, 0]}}, "
      "{box: {size_m: [0.018, 0.018, 0.06], center_m: [0, 0, 0]}}]}");
  EXPECT_NEAR(number(check_casting(robot, {}), "aspect", "worst"), 50 / 18.0, 0.01);
}

TEST(CheckCasting, LetsACylinderLeaveAlongItsAxis) {
  CastRobot robot;
  robot.surface = meshed("{cylinder: {start_m: [0, 0, 0], end_m: [0, 0, 0.03], radius_m: 0.015}}");
  CastingSettings settings;
  settings.direction = kUp;
  EXPECT_EQ(failures(check_casting(robot, settings)), "");
}

}  // namespace
}  // namespace soft_robot_lab
