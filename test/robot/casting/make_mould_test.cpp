// SPDX-License-Identifier: BSD-3-Clause
// Moulds by the real mesher, against closed forms.
#include "robot/casting/make_mould.h"

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "read_three_mf.h"
#include "robot/casting/air_traps.h"
#include "robot/casting/verdict_page.h"
#include "robot/design/surface_file.h"
#include "robot/scene/scene_files.h"
#include "run_program.h"
#include "shapes.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;

// A robot's file of one solid, clamped somewhere.
CastRobotFile robot_of(const SceneFolder& folder, const std::string& solid, const std::string& casting = "{}") {
  const std::string file = folder.write("robot.yaml", "body:\n  solid: " + solid +
                                                          "\n  element_size_m: 0.02\n"
                                                          "  material: {youngs_modulus_pa: 264200, poissons_ratio: "
                                                          "0.499, density_kg_m3: 1070}\n"
                                                          "  fixed: [{box: {min_m: [-1, -1, -1], max_m: [1, 1, "
                                                          "0.001]}}]\ncasting: " +
                                                          casting + "\n");
  SceneOptions options;
  options.actuator_factory = make_actuator;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  return load_cast_robot(file, options);
}

std::string refusal(const CastRobotFile& file) {
  try {
    const Mould mould = make_mould(file);
    return mould.faults.empty() ? "made" : mould.faults[0];
  } catch (const NoMould& error) {
    return std::string("no mould: ") + error.what();
  }
}

const char* const kBox = "{box: {size_m: [0.04, 0.03, 0.02], center_m: [0, 0, 0.01]}}";
// Two heads and a narrower beam: undercut in every direction, but its halves part across y.
const char* const kHammer =
    "{union: [{box: {size_m: [0.04, 0.02, 0.01], center_m: [0, 0, 0.005]}}, "
    "{box: {size_m: [0.012, 0.012, 0.022], center_m: [0, 0, 0.02]}}, "
    "{box: {size_m: [0.04, 0.02, 0.01], center_m: [0, 0, 0.035]}}]}";

TEST(MakeMould, MakesABoxsMouldToItsClosedForm) {
  const SceneFolder folder;
  const CastRobotFile file = robot_of(folder, kBox, "{direction: [0, 0, 1], wall_m: 0.005}");
  const Mould mould = make_mould(file);
  ASSERT_EQ(mould.parts.size(), 1u);
  EXPECT_TRUE(mould.faults.empty()) << mould.faults[0];
  EXPECT_NEAR(mould.parts[0].surface.volume_m3(), (0.05 * 0.04 * 0.025 - 0.04 * 0.03 * 0.02), 1e-12);
  Eigen::Vector3d size = mould.parts[0].size_m();
  EXPECT_NEAR(size.z(), 0.025, 1e-8);
  EXPECT_NEAR(std::max(size.x(), size.y()), 0.05, 1e-8);
  EXPECT_NEAR(std::min(size.x(), size.y()), 0.04, 1e-8);
  EXPECT_LT(mould.closure, 1e-6);
  EXPECT_LT(mould.cavity_distance_m, 1e-7);
  EXPECT_NEAR(mould.parts[0].thinnest_m, 0.005, 1e-6);
  SurfaceRequest step;
  step.solid.kind = Solid::Kind::step_file;
  step.solid.file = mould.parts[0].step_file;
  const Surface again = read_off(surface_file_for(step, file.mesher));
  EXPECT_NEAR(again.volume_m3(), mould.parts[0].surface.volume_m3(), 1e-12);
  EXPECT_NEAR((again.vertices_m.rowwise().maxCoeff() - size).norm(), 0, 1e-8) << "as it stands on the bed";
}

TEST(MakeMould, LeavesOutWhatIsBondedInAfterwards) {
  const SceneFolder folder;
  const char* const closed =
      "{difference: [{box: {size_m: [0.02, 0.02, 0.02], center_m: [0, 0, 0.01]}}, "
      "{box: {size_m: [0.01, 0.01, 0.01], center_m: [0, 0, 0.01]}}]}";
  const std::string up = "{direction: [0, 0, 1], air_holes: true";
  EXPECT_NE(refusal(robot_of(folder, closed, up + "}")).find("bond a lid"), std::string::npos);
  const Mould mould = make_mould(
      robot_of(folder, closed, up + ", bonded: [{box: {size_m: [0.01, 0.01, 0.007], center_m: [0, 0, 0.0025]}}]}"));
  EXPECT_TRUE(mould.faults.empty()) << mould.faults[0];
  EXPECT_NEAR(mould.robot_volume_m3, 8e-6 - 1e-6 - 0.5e-6, 1e-12);
  EXPECT_NE(mould_instructions(mould, "cup").find("bond them in"), std::string::npos);
}

TEST(MakeMould, WeighsTheSilicone) {
  const SceneFolder folder;
  const Mould mould = make_mould(robot_of(folder, kBox, "{part_a_fraction: 0.25, spare_fraction: 0.2}"));
  EXPECT_NEAR(mould.silicone.mass_g, 24e-6 * 1.2 * 1070 * 1000, 1e-6);
  EXPECT_NEAR(mould.silicone.part_a_g, 0.25 * mould.silicone.mass_g, 1e-9);
  EXPECT_NEAR(mould.silicone.part_a_g + mould.silicone.part_b_g, mould.silicone.mass_g, 1e-9);
}

TEST(MakeMould, StandsWithItsOpenSideUp) {
  const SceneFolder folder;
  const Mould mould = make_mould(robot_of(folder, kBox, "{direction: [0, -1, 0]}"));
  const MouldPart& part = mould.parts[0];
  EXPECT_NEAR((part.rotation * Eigen::Vector3d(0, -1, 0) - Eigen::Vector3d::UnitZ()).norm(), 0, 1e-12);
  EXPECT_NEAR(part.size_m().z(), 0.03 + 0.004, 1e-8);
  EXPECT_NEAR(part.surface.vertices_m.minCoeff(), 0, 1e-12);
}

TEST(MakeMould, LeavesARoundCavityWithinATenthOfAMillimetre) {
  const SceneFolder folder;
  const Mould mould = make_mould(
      robot_of(folder, "{cone: {start_m: [0, 0, 0], end_m: [0, 0, 0.03], radius_m: 0.0155, end_radius_m: 0.0165}}"));
  EXPECT_TRUE(mould.faults.empty()) << mould.faults[0];
  EXPECT_GT(mould.cavity_distance_m, 0);
  EXPECT_LT(mould.cavity_distance_m, 1e-4);
  EXPECT_LT(mould.closure, 1e-3);
}

TEST(MakeMould, PartsTwoHalvesToTheirClosedForm) {
  const SceneFolder folder;
  const Mould mould = make_mould(robot_of(folder, kHammer, "{allow: [two_part]}"));
  ASSERT_EQ(mould.parts.size(), 2u);
  EXPECT_TRUE(mould.faults.empty()) << mould.faults[0];
  EXPECT_EQ(mould.plan.direction, Eigen::Vector3d::UnitY());
  EXPECT_EQ(mould.plan.bolts, 4);
  EXPECT_EQ(mould.plan.keys, 2);
  // Block of 48 x 28 x 44 mm, flanges of 12 x 8 mm on both sides, bolts, pegs and sockets.
  const auto cone = [](double h, double r, double s) { return kPi / 3 * h * (r * r + r * s + s * s); };
  const double block = (0.048 * 0.028 + 2 * 0.012 * 0.008) * 0.044 - 4 * kPi * 0.0022 * 0.0022 * 0.008 +
                       2 * (cone(0.002, 0.0025, 0.0015) - cone(0.0022, 0.0027, 0.0017));
  EXPECT_NEAR(mould.plan.block_volume_m3, block, 1e-12);
  // Air under the roof of the lower head, on both sides of the beam, has a way up to the upper head.
  ASSERT_EQ(mould.plan.vents.size(), 2u);
  EXPECT_NEAR(mould.plan.vents[0].from_m.x() + mould.plan.vents[1].from_m.x(), 0, 1e-4);
  EXPECT_NEAR((mould.plan.vents[0].to_m - mould.plan.vents[0].from_m).norm(), 0.02, 1e-6);
  EXPECT_NEAR(mould.plan.flash_m3, 2 * kPi * 0.0005 * 0.0005 * 0.02, 1e-13);
  EXPECT_NEAR(mould.robot_volume_m3, 2 * 0.04 * 0.02 * 0.01 + 0.012 * 0.012 * 0.02 + mould.plan.flash_m3,
              0.12 * mould.plan.flash_m3)
      << "bores have few edges";
  EXPECT_LT(mould.closure, kLargestClosure);
  for (const MouldPart& part : mould.parts) EXPECT_EQ(part.surface.shell_volumes_m3.size(), 1u);
}

TEST(MakeMould, PoursThroughASprueWhereNoSideIsFlat) {
  const SceneFolder folder;
  const char* const ball = "{sphere: {radius_m: 0.02, center_m: [0, 0, 0]}}";
  const Mould mould = make_mould(robot_of(folder, ball, "{allow: [two_part]}"));
  EXPECT_TRUE(mould.faults.empty()) << mould.faults[0];
  ASSERT_TRUE(mould.plan.sprue);
  EXPECT_TRUE(mould.plan.vents.empty()) << "its highest place is the sprue's";
  EXPECT_NEAR(mould.plan.sprue->from_m.norm(), 0.02, 1e-4);
  const double above = kPi / 3 * 0.012 * (16 + 32 + 64) * 1e-6;
  EXPECT_NEAR(mould.plan.flash_m3, above, 1e-3 * above);
  EXPECT_NEAR(mould.robot_volume_m3, 4 * kPi / 3 * 8e-6 + above, 2e-3 * 33.5e-6);
  EXPECT_NE(mould_instructions(mould, "ball").find("through the sprue"), std::string::npos);
  EXPECT_NE(refusal(robot_of(folder, ball, "{allow: [two_part], sprue_radius_m: 0.015}")).find("sprue_radius_m"),
            std::string::npos);
}

TEST(MakeMould, NamesTheNewNameOfAnOldKey) {
  const SceneFolder folder;
  const auto refused = [&](const std::string& casting) {
    try {
      robot_of(folder, "{sphere: {radius_m: 0.02}}", casting);
    } catch (const SettingsError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(refused("{spout_radius_m: 0.004}").find("spout_radius_m is called sprue_radius_m now"), std::string::npos);
}

TEST(MakeMould, GivesAirAWayOutOfEachLocalTop) {
  // Two horns on a foot, the one on the left higher: the right one needs a vent.
  const SceneFolder folder;
  const std::string solid =
      "{union: [{box: {size_m: [0.06, 0.02, 0.01], center_m: [0, 0, 0.005]}}, "
      "{cone: {start_m: [-0.02, 0, 0.005], end_m: [-0.02, 0, 0.04], radius_m: 0.008, end_radius_m: 0.004}}, "
      "{cone: {start_m: [0.02, 0, 0.005], end_m: [0.02, 0, 0.025], radius_m: 0.008, end_radius_m: 0.004}}]}";
  const CastRobotFile file = robot_of(folder, solid);
  const Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();
  const std::vector<AirTrap> traps = find_air_traps(RayTree(file.robot.surface), frame, 0);
  ASSERT_EQ(traps.size(), 3u) << "both horns, and the foot's roof between them, but not the 2.6 mm beside";
  EXPECT_NEAR(traps[0].height_m, 0.04, 1e-7);
  EXPECT_NEAR(traps[0].across_m, -0.02, 1e-4);
  EXPECT_NEAR(traps[1].height_m, 0.025, 1e-7);
  EXPECT_NEAR(traps[1].across_m, 0.02, 1e-4);
  EXPECT_NEAR(traps[2].height_m, 0.01, 1e-7);
  EXPECT_NEAR(traps[2].across_m, 0, 3e-4);
}

TEST(MakeMould, OpensAirHolesUnderCores) {
  const SceneFolder folder;
  const std::string cup =
      "{difference: [{box: {size_m: [0.03, 0.03, 0.03], center_m: [0, 0, 0.015]}}, "
      "{cylinder: {start_m: [0, 0, -0.01], end_m: [0, 0, 0.02], radius_m: 0.008}}]}";
  EXPECT_NE(refusal(robot_of(folder, cup, "{direction: [0, 0, 1], max_suction_strain: 0.01}")).find("suction"),
            std::string::npos);
  const Mould mould = make_mould(robot_of(folder, cup, "{direction: [0, 0, 1], air_holes: true}"));
  EXPECT_TRUE(mould.faults.empty()) << mould.faults[0];
  EXPECT_EQ(mould.plan.air_holes.size(), 1u);
  // 34 mm of block's floor below and core, of which the hole takes 24.
  EXPECT_NEAR(mould.plan.block_volume_m3, 0.038 * 0.038 * 0.034 - kPi * 0.0005 * 0.0005 * 0.024, 1e-12);
}

// Two cavities of 12 x 10 x 6 mm in a block of 40 x 20 x 12 mm, under 2 mm of lid.
const char* const kHollow =
    "{difference: [{box: {size_m: [0.04, 0.02, 0.012], center_m: [0, 0, 0.006]}}, "
    "{box: {size_m: [0.012, 0.01, 0.006], center_m: [-0.01, 0, 0.007]}}, "
    "{box: {size_m: [0.012, 0.01, 0.006], center_m: [0.01, 0, 0.007]}}]}";

TEST(MakeMould, CastsAHollowBlockInTwoPoursUnderALid) {
  const SceneFolder folder;
  const Mould mould = make_mould(robot_of(folder, kHollow, "{allow: [lid]}"));
  EXPECT_TRUE(mould.faults.empty()) << mould.faults[0];
  ASSERT_EQ(mould.parts.size(), 3u);
  EXPECT_EQ(mould.parts[0].name + mould.parts[1].name + mould.parts[2].name, "basecorelid_tray");
  EXPECT_EQ(mould.plan.direction, Eigen::Vector3d::UnitZ());
  EXPECT_NEAR(mould.plan.rim_m, 0.01, 1e-9);
  EXPECT_NEAR(mould.plan.first_pour_m3, 0.04 * 0.02 * 0.01 - 2 * 0.012 * 0.01 * 0.006, 1e-12);
  EXPECT_NEAR(mould.parts[0].surface.volume_m3(), 0.048 * 0.028 * 0.014 - 0.04 * 0.02 * 0.01, 1e-11);
  EXPECT_NEAR(mould.parts[2].surface.volume_m3(), 0.048 * 0.028 * 0.006 - 0.04 * 0.02 * 0.002, 1e-11);
  EXPECT_LT(mould.closure, 1e-6);
  EXPECT_LT(mould.equation_distance_m, 1e-4);
  EXPECT_EQ(mould.plan.air_holes.size(), 2u);
  EXPECT_NE(mould_instructions(mould, "block").find("into lid_tray"), std::string::npos);
}

TEST(MakeMould, CountsARobotAsCastableInAMouldThatItsFileAllows) {
  const SceneFolder folder;
  const auto judged = [&](const char* solid, const std::string& casting) {
    const CastRobotFile file = robot_of(folder, solid, casting);
    return with_allowed_moulds(file, check_casting(file));
  };
  EXPECT_FALSE(judged(kHollow, "{}").castable);
  EXPECT_FALSE(judged(kHollow, "{allow: [two_part]}").castable);
  const CastingVerdict in_two_pours = judged(kHollow, "{allow: [lid]}");
  EXPECT_TRUE(in_two_pours.castable);
  EXPECT_EQ(in_two_pours.test("cavities").by, "lid");
  EXPECT_EQ(in_two_pours.test("cavities").cause, "trapped core");
  EXPECT_NE(verdict_json(in_two_pours).find("\"by\": \"lid\""), std::string::npos);
  const CastingVerdict in_halves = judged(kHammer, "{allow: [two_part]}");
  EXPECT_TRUE(in_halves.castable);
  EXPECT_EQ(in_halves.test("extraction").by, "two_part");
  EXPECT_EQ(in_halves.test("thickness").by, "");
}

TEST(MakeMould, PutsMarginsIntoWords) {
  const SceneFolder folder;
  const CastingVerdict verdict = check_casting(robot_of(folder, kBox, "{direction: [0, 0, 1], min_draft_deg: 0}"));
  EXPECT_EQ(margin_text(verdict.test("extraction")), "draft 0 deg, at least 0 deg; held skin 0 mm^2");
  EXPECT_EQ(margin_text(verdict.test("thickness")), "20 mm, at least 2 mm");
  EXPECT_EQ(margin_text(verdict.test("angles")), "90 deg, at least 15 deg");
  EXPECT_EQ(margin_text(verdict.test("cables")), "") << "it has none";
  EXPECT_EQ(margin_text(verdict.test("stretch")), "1, at most 1.5");
}

TEST(MakeMould, RefusesALidWhereNoCoreLeaves) {
  const SceneFolder folder;
  const std::string ball =
      "{difference: [{box: {size_m: [0.04, 0.04, 0.04], center_m: [0, 0, 0.02]}}, "
      "{sphere: {radius_m: 0.01, center_m: [0, 0, 0.02]}}]}";
  EXPECT_NE(refusal(robot_of(folder, ball, "{allow: [lid]}")).find("no plane along the robot's axes"),
            std::string::npos);
}

// Of a robot whose file is `solid`: what the check says of it, and what making its mould says.
void expect_one_verdict(const std::string& solid, const std::string& casting, const std::string& words) {
  const SceneFolder folder;
  const CastRobotFile file = robot_of(folder, solid, casting);
  const CastingVerdict verdict = with_allowed_moulds(file, check_casting(file));
  EXPECT_FALSE(verdict.castable);
  const std::string said = refusal(file);
  EXPECT_NE(said.find(words), std::string::npos) << said;
  for (const CastingTest& test : verdict.tests) EXPECT_NE(said.find(test.passed ? "" : test.why), std::string::npos);
}

// Its outside and its inside widen upwards: a core on the upper half would do, which no flat plane makes.
constexpr char kCup[] =
    "{difference: [{cone: {start_m: [0, 0, 0], end_m: [0, 0, 0.03], radius_m: 0.019, end_radius_m: 0.02}}, "
    "{cone: {start_m: [0, 0, 0.005], end_m: [0, 0, 0.0301], radius_m: 0.014, end_radius_m: 0.015}}]}";

TEST(MakeMould, RefusesInTheSameWordsAsTheCheck) {
  expect_one_verdict(kCup, "{allow: [two_part, lid], air_holes: true}", "makes no mould of two halves");
  expect_one_verdict(kHammer, "{}", "casting: {allow: [two_part]}");
  expect_one_verdict(kHollow, "{}", "casting: {allow: [lid]}");
  expect_one_verdict(kBox, "{printer_m: [0.03, 0.03, 0.2]}", "printer_m");
}

TEST(MakeMould, RefusesACoreThatIsTooThinToBePrinted) {
  expect_one_verdict(
      "{difference: [{box: {size_m: [0.02, 0.02, 0.004], center_m: [0, 0, 0]}}, "
      "{box: {size_m: [0.001, 0.001, 0.01], center_m: [0, 0, 0]}}]}",
      "{}", "casting.min_wall_m");
}

TEST(MakeMould, RefusesWhatItCannotMakeAndNamesWhatWouldHelp) {
  const SceneFolder folder;
  EXPECT_NE(refusal(robot_of(folder, kHammer)).find("--allow two_part"), std::string::npos);
  const std::string hollow =
      "{difference: [{box: {size_m: [0.02, 0.02, 0.02], center_m: [0, 0, 0.01]}}, "
      "{box: {size_m: [0.01, 0.01, 0.01], center_m: [0, 0, 0.01]}}]}";
  EXPECT_NE(refusal(robot_of(folder, hollow, "{allow: [two_part]}")).find("bond a lid"), std::string::npos);
  const std::string ball = refusal(robot_of(folder, "{sphere: {radius_m: 0.02, center_m: [0, 0, 0]}}"));
  EXPECT_EQ(ball.rfind("no mould: ", 0), 0u) << ball;
  EXPECT_NE(refusal(robot_of(folder, kBox, "{printer_m: [0.03, 0.03, 0.2]}")).find("printer_m"), std::string::npos);
  EXPECT_NE(refusal(robot_of(folder, kBox, "{wall_m: 0.002, min_wall_m: 0.003}")).find("min_wall_m"),
            std::string::npos);
  EXPECT_NE(refusal(robot_of(folder, kHammer, "{allow: [two_part], flange_m: 0.005}")).find("flange_m"),
            std::string::npos);
}

TEST(MakeMould, RefusesKeysThatItDoesNotKnow) {
  const SceneFolder folder;
  EXPECT_THROW(robot_of(folder, kBox, "{allow: [lost_wax]}"), SettingsError);
  EXPECT_THROW(robot_of(folder, kBox, "{wall_m: 0}"), SettingsError);
  EXPECT_THROW(robot_of(folder, kBox, "{printer_m: [0.2, 0, 0.2]}"), SettingsError);
}

TEST(MakeMould, RefusesAFolderBeforeItWorks) {
  const SceneFolder folder;
  folder.write("file", "");
  EXPECT_THROW(require_mould_folder(folder.path("file")), std::runtime_error);
  EXPECT_THROW(require_mould_folder(folder.path("file/below")), std::runtime_error);
  EXPECT_THROW(require_mould_folder("/proc/mould"), std::runtime_error);
  EXPECT_NO_THROW(require_mould_folder(folder.path("new/mould")));
}

Outcome run(const SceneFolder& folder, const std::string& arguments) {
  return run_program(SOFT_ROBOT_LAB_MAKE_MOULD, folder, arguments);
}

const std::string kRobots = SOFT_ROBOT_LAB_SOURCE "/config/robots/";

CastRobotFile cast_robot(const std::string& name, const std::string& file = "robot.yaml") {
  SceneOptions options;
  options.actuator_factory = make_actuator;
  options.mesher = SOFT_ROBOT_LAB_MESHER;
  return load_cast_robot(kRobots + name + "/" + file, options);
}

double length_m(const SheathPath& path) {
  double length = 0;
  for (size_t i = 0; i + 1 < path.points_m.size(); ++i) length += (path.points_m[i + 1] - path.points_m[i]).norm();
  return length;
}

TEST(MakeMould, LetsTheCastableRobotsOutAsTheSourcesWere) {
  for (const auto& [name, cable_m] : {std::pair{"spinebot", 0.0805}, {"hammerbot", 0.1}}) {
    const CastRobotFile file = cast_robot(name);
    const CastingVerdict verdict = check_casting(file);
    EXPECT_TRUE(verdict.castable) << name;
    EXPECT_EQ(verdict.direction, Eigen::Vector3d::UnitY());
    ASSERT_EQ(file.robot.sheaths.size(), 2u);
    for (const SheathPath& path : file.robot.sheaths) EXPECT_NEAR(length_m(path), cable_m, 1e-12) << name;
  }
  for (const char* finger : {"finger_a1", "finger_a2"})
    EXPECT_TRUE(check_casting(cast_robot(finger)).castable) << finger;
}

double number(const CastingTest& test, const std::string& key) {
  for (const auto& [name, value] : test.numbers)
    if (name == key) return value;
  throw std::out_of_range(key);
}

// What happened to the source's: three cores, here of 943.1 mm^2, stood in a vacuum, and were torn off.
TEST(MakeMould, RefusesBubblebotsSealedCoresForTheirVacuumAndPassesThemWithAirHoles) {
  const CastRobotFile sealed = cast_robot("bubblebot", "sealed_cores.yaml");
  const CastingVerdict verdict = check_casting(sealed);
  EXPECT_FALSE(verdict.castable);
  const CastingTest& suction = verdict.test("suction");
  EXPECT_FALSE(suction.passed);
  EXPECT_EQ(suction.cause, "vacuum under blind pockets");
  EXPECT_NEAR(number(suction, "force_n"), 3 * 943.1235e-6 * 101325, 0.1);
  EXPECT_NE(refusal(sealed).find("air holes"), std::string::npos);
  EXPECT_TRUE(check_casting(cast_robot("bubblebot")).castable);
}

// A second opinion on an STL file, where admesh is installed: all its counts of what it had to mend.
void expect_admesh_finds_no_fault(const SceneFolder& folder, const std::string& stl) {
  if (std::system("command -v admesh >/dev/null") != 0) return;
  const Outcome outcome = run_program("admesh", folder, stl);
  EXPECT_EQ(outcome.exit_status, 0);
  EXPECT_NE(outcome.out.find("Number of parts       :     1 "), std::string::npos) << outcome.out;
  for (const char* fault : {"Total disconnected facets        ", "Degenerate facets     ", "Edges fixed           ",
                            "Facets removed        ", "Facets reversed       ", "Backwards edges       "})
    EXPECT_NE(outcome.out.find(fault + std::string(":     0")), std::string::npos) << fault << outcome.out;
}

TEST(MakeMould, WritesTheHangingBarsMouldWhole) {
  const SceneFolder folder;
  const std::string output = folder.path("mould"), arguments = kRobots + "hanging_bar/robot.yaml --output " + output;
  ASSERT_EQ(run(folder, arguments).exit_status, 0) << contents(folder.path("err"));
  const std::string stl = contents(output + "/mould.stl");
  ASSERT_GT(stl.size(), 84u);
  std::uint32_t triangles = 0;
  std::memcpy(&triangles, stl.data() + 80, 4);
  EXPECT_EQ(stl.size(), 84 + 50 * static_cast<size_t>(triangles));
  expect_admesh_finds_no_fault(folder, output + "/mould.stl");
  EXPECT_EQ(read_three_mf(contents(output + "/mould.3mf")).triangle_count(), static_cast<int>(triangles));
  for (const char* picture : {"/mould.png", "/robot.png"})
    EXPECT_EQ(contents(output + picture).substr(1, 3), "PNG") << picture;
  EXPECT_NE(contents(output + "/mould.json").find("\"fits_printer\": true"), std::string::npos);
  EXPECT_NE(contents(output + "/instructions.html").find("Casting hanging_bar"), std::string::npos);
  EXPECT_EQ(run(folder, arguments).exit_status, 0) << "an earlier mould is replaced";
  for (const auto& entry : fs::directory_iterator(fs::path(output).parent_path()))
    EXPECT_EQ(entry.path().filename().string().rfind("mould.", 0), std::string::npos) << entry.path();
}

TEST(MakeMould, WritesHammerbotsMouldWithItsShelves) {
  const SceneFolder folder;
  const std::string output = folder.path("mould");
  const Outcome outcome = run(folder, kRobots + "hammerbot/robot.yaml --output " + output);
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  expect_admesh_finds_no_fault(folder, output + "/mould.stl");
  const std::string json = contents(output + "/mould.json"), steps = contents(output + "/instructions.html");
  EXPECT_NE(json.find("\"cable\": \"left\""), std::string::npos);
  EXPECT_NE(steps.find("right, 15.0 mm, outside 2.0 mm"), std::string::npos) << steps;
  EXPECT_EQ(steps.find("modelling clay"), std::string::npos) << "no sheath crosses a tooth";
}

TEST(MakeMould, RefusesBubblefingerForItsTrappedCoreAndPassesItWithALid) {
  const CastingVerdict verdict = check_casting(cast_robot("bubblefinger"));
  EXPECT_FALSE(verdict.castable);
  EXPECT_EQ(verdict.test("cavities").cause, "trapped core");
  EXPECT_NEAR(number(verdict.test("cavities"), "volume_m3"), 19.824e-6, 1e-9);
  const CastRobotFile with_lid = cast_robot("bubblefinger", "lid.yaml");
  EXPECT_TRUE(with_allowed_moulds(with_lid, check_casting(with_lid)).castable);
}

TEST(MakeMould, WritesBubblefingersMouldForTwoPours) {
  const SceneFolder folder;
  const std::string output = folder.path("mould"), arguments = kRobots + "bubblefinger/robot.yaml --output " + output;
  const Outcome refused = run(folder, arguments);
  EXPECT_EQ(refused.exit_status, 1);
  EXPECT_NE(refused.err.find("bond a lid on"), std::string::npos) << refused.err;
  const Outcome outcome = run(folder, kRobots + "bubblefinger/lid.yaml --output " + output);
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  for (const char* part : {"base", "core", "lid_tray"})
    expect_admesh_finds_no_fault(folder, output + "/" + part + ".stl");
}

TEST(MakeMould, PaintsAVerdict) {
  const SceneFolder folder;
  const CastRobotFile file = robot_of(folder, kHammer);
  const CastingVerdict verdict = check_casting(file);
  ASSERT_FALSE(verdict.blocked.empty());
  write_verdict(verdict, "hammer", 0.002, folder.path("page"));
  const std::string page = contents(folder.path("page/verdict.html"));
  EXPECT_NE(page.find("hammer cannot be cast"), std::string::npos);
  EXPECT_NE(page.find("are held by the mould"), std::string::npos);
  const auto reds = [&](const std::string& picture) {
    const cv::Mat image = cv::imread(folder.path("page/" + picture));
    int count = 0;
    for (int row = 0; row < image.rows; ++row)
      for (int column = 0; column < image.cols; ++column) {
        const cv::Vec3b pixel = image.at<cv::Vec3b>(row, column);
        count += pixel[2] > 2 * pixel[1] && pixel[2] > 2 * pixel[0] ? 1 : 0;
      }
    return count;
  };
  EXPECT_GT(reds("from_above.png"), 1000) << "skin in the way faces up";
  EXPECT_EQ(reds("from_below.png"), 0);
}

TEST(MakeMould, WritesZerosOfDirectionsWithoutASign) {
  Mould mould;
  mould.plan.direction = Eigen::Vector3d(-0.0, -0.0, 1);
  mould.plan.frame = -Eigen::Matrix3d::Identity();
  EXPECT_EQ(mould_json(mould).find("-0.0"), std::string::npos) << mould_json(mould);
  EXPECT_NE(mould_instructions(mould, "bar").find("along [0 0 1]"), std::string::npos)
      << mould_instructions(mould, "bar");
}

TEST(MakeMould, LeavesFoldersOfOthersAlone) {
  const SceneFolder folder;
  folder.write("mine/notes.txt", "kept");
  const Outcome outcome = run(folder, kRobots + "hanging_bar/robot.yaml --output " + folder.path("mine"));
  EXPECT_EQ(outcome.exit_status, 2);
  const Outcome sooner = run(folder, folder.path("missing.yaml") + " --output " + folder.path("mine"));
  EXPECT_NE(sooner.err.find("other files"), std::string::npos) << "before the robot is read: " << sooner.err;
  EXPECT_NE(outcome.err.find("other files"), std::string::npos) << outcome.err;
  EXPECT_EQ(contents(folder.path("mine/notes.txt")), "kept");
  // Nor what somebody laid beside an earlier mould, or made of it.
  const std::string parts = R"({"parts": [{"name": "mould"}]})";
  folder.write("older/mould.json", parts);
  folder.write("older/mould.stl", "an older mould");
  const std::string robot = folder.write("older/robot.yaml", "include: \"" + kRobots + "hanging_bar/robot.yaml\"\n");
  const Outcome beside = run(folder, robot + " --output " + folder.path("older"));
  EXPECT_EQ(beside.exit_status, 2);
  EXPECT_NE(beside.err.find("other files than a mould, as robot.yaml"), std::string::npos) << beside.err;
  EXPECT_EQ(contents(folder.path("older/mould.stl")), "an older mould");
  folder.write("used/mould.json", parts);
  fs::copy_file(std::string(SOFT_ROBOT_LAB_SOURCE) + "/test/data/cylinder.step", folder.path("used/mould.step"));
  const std::string scene = folder.write("used.yaml", "body: {solid: {step: used/mould.step}}");
  const Outcome used = run(folder, scene + " --output " + folder.path("used"));
  EXPECT_EQ(used.exit_status, 2);
  EXPECT_NE(used.err.find("mould.step: would be replaced, though it was read"), std::string::npos) << used.err;
  EXPECT_TRUE(fs::exists(folder.path("used/mould.step")));
}

TEST(MakeMould, NeedsNothingHeldAndMakesTheMouldOfASleeve) {
  const SceneFolder folder;
  const std::string sleeve =
      "body: {solid: {difference: [{cylinder: {start_m: [0, 0, 0], end_m: [0, 0, 0.02], radius_m: 0.012}}, "
      "{cylinder: {start_m: [0, 0, -0.001], end_m: [0, 0, 0.021], radius_m: 0.008}}]}}";
  const Outcome outcome = run(folder, folder.write("sleeve.yaml", sleeve) + " --output " + folder.path("mould"));
  EXPECT_EQ(outcome.exit_status, 0) << outcome.err;
}

TEST(MakeMould, SaysWhyFacetsHaveNoMouldAndWhatHas) {
  const SceneFolder folder;
  const std::string arguments = " --output " + folder.path("mould");
  const std::string stl = SOFT_ROBOT_LAB_SOURCE "/test/data/hollow_box.stl";
  for (const std::string& body :
       {"solid: {stl: " + stl + "}", "solid: {translate: {solid: {stl: " + stl + "}, by_m: [0, 0, 1]}}",
        std::string("mesh: body.vtk")}) {
    const Outcome outcome = run(folder, folder.write("facets.yaml", "body: {" + body + ", scale: 0.001}") + arguments);
    EXPECT_EQ(outcome.exit_status, 2) << outcome.err;
    EXPECT_NE(outcome.err.find("facets.yaml"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("facets"), std::string::npos) << "why: " << outcome.err;
    EXPECT_NE(outcome.err.find("`solid: {step: FILE.step}`"), std::string::npos) << "what to do: " << outcome.err;
  }
  EXPECT_FALSE(fs::exists(folder.path("mould")));
}

TEST(MakeMould, EndsWithOneWhereNoMouldCanBeMadeAndWithTwoForABadFile) {
  const SceneFolder folder;
  const std::string output = " --output " + folder.path("mould");
  EXPECT_EQ(run(folder, kRobots + "bubblefinger/robot.yaml" + output).exit_status, 1);
  EXPECT_FALSE(fs::exists(folder.path("mould")));
  EXPECT_EQ(run(folder, folder.write("bad.yaml", "body: {solid: {box: 3}}") + output).exit_status, 2);
  EXPECT_EQ(run(folder, folder.path("missing.yaml") + output).exit_status, 2);
  EXPECT_EQ(run(folder, kRobots + "hammerbot/robot.yaml --allow wax" + output).exit_status, 2);
  EXPECT_FALSE(fs::exists(folder.path("mould")));
}

}  // namespace
}  // namespace soft_robot_lab
