// SPDX-License-Identifier: BSD-3-Clause
#include "check_casting.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "angles.h"
#include "extraction.h"
#include "pockets.h"
#include "shelves.h"
#include "squeeze.h"
#include "thickness.h"

namespace soft_robot_lab {
namespace {

template <typename... Parts>
std::string sentence(const Parts&... parts) {
  std::ostringstream text;
  text.precision(4);
  (text << ... << parts);
  return text.str();
}

std::string mm(double value_m) { return sentence(1000 * value_m, " mm"); }

CastingTest extraction_test(const Extraction& out, const TwoPart& halves, bool given, double min_draft_deg) {
  CastingTest test{"extraction", out.passed && out.draft_deg >= min_draft_deg - 0.1, {}, {}, "", ""};
  test.numbers = {{"draft_deg", std::abs(out.draft_deg) < 1e-9 ? 0 : out.draft_deg},
                  {"min_draft_deg", min_draft_deg},
                  {"blocked_area_m2", out.blocked_area_m2},
                  {"undercut_volume_m3", out.undercut_volume_m3},
                  {"trap_depth_m", out.trap_depth_m},
                  {"blocked_facets", static_cast<double>(out.blocked.size())},
                  {"top_area_m2", out.top_area_m2},
                  {"two_part_blocked_area_m2", halves.blocked_area_m2},
                  {"two_part_undercut_volume_m3", halves.undercut_volume_m3}};
  if (test.passed) return test;
  const std::string way = given ? "along the given direction" : "along any direction";
  if (!out.blocked.empty()) {
    test.at_m = out.at_m;
    test.why = sentence(1e6 * out.blocked_area_m2, " mm^2 of skin are held by the mould ", way, ", by up to ",
                        mm(out.trap_depth_m), " at ", place_text(out.at_m), ".");
  } else if (!(out.top_area_m2 > 0)) {
    test.why = "No flat side can be open to air while the silicone cures.";
  } else {
    test.why = sentence("The least draft is ", out.draft_deg, " degrees, below min_draft_deg.");
  }
  return test;
}

CastingTest cavities_test(const Surface& surface) {
  CastingTest test{"cavities", true, {}, {}, "", ""};
  int count = 0;
  double volume = 0;
  for (size_t shell = 0; shell < surface.shell_volumes_m3.size(); ++shell) {
    if (surface.shell_volumes_m3[shell] > 0) continue;
    ++count;
    volume -= surface.shell_volumes_m3[shell];
    if (test.at_m) continue;
    const auto found = std::find(surface.shell.begin(), surface.shell.end(), static_cast<int>(shell));
    test.at_m = surface.centre(static_cast<int>(found - surface.shell.begin()));
  }
  test.passed = count == 0;
  test.numbers = {{"count", count}, {"volume_m3", volume}};
  if (test.passed) return test;
  test.cause = "trapped core";
  test.why = sentence(count, count == 1 ? " cavity of " : " cavities of together ", 1e6 * volume,
                      " ml closed all round would keep the mould's core: open an end, hold a core at an intake, bond a "
                      "lid on in a second pour, or melt the core out.");
  return test;
}

CastingTest thickness_test(const Thickness& thickness, double limit_m) {
  const bool by_ball = thickness.ball.worst_m <= thickness.cone.worst_m;
  const ThinPlace& worst = by_ball ? thickness.ball : thickness.cone;
  constexpr double kExact = 1 - 1e-3;  // what facets take from a round wall
  CastingTest test{"thickness", worst.worst_m >= limit_m * kExact, {}, {}, "", ""};
  test.numbers = {{"worst_m", worst.worst_m},
                  {"limit_m", limit_m},
                  {"ball_worst_m", thickness.ball.worst_m},
                  {"cone_worst_m", thickness.cone.worst_m},
                  {"area_m2", std::max(thickness.ball.area_m2, thickness.cone.area_m2)}};
  if (std::isfinite(worst.worst_m)) test.at_m = worst.at_m;
  if (!test.passed)
    test.why = sentence("The silicone is ", mm(worst.worst_m), " thick at ", place_text(worst.at_m), ", less than ",
                        mm(limit_m), ".");
  return test;
}

CastingTest angles_test(const EdgeAngles& angles, double limit_deg) {
  const bool notch = angles.notch.opening_deg <= angles.wedge.opening_deg;
  const SharpEdge& worst = notch ? angles.notch : angles.wedge;
  CastingTest test{"angles", worst.opening_deg >= limit_deg, {}, {}, "", ""};
  test.numbers = {{"worst_deg", worst.opening_deg},
                  {"limit_deg", limit_deg},
                  {"notch_deg", angles.notch.opening_deg},
                  {"wedge_deg", angles.wedge.opening_deg},
                  {"length_m", angles.notch.length_m + angles.wedge.length_m}};
  if (worst.opening_deg < 180) test.at_m = worst.at_m;
  if (!test.passed)
    test.why = sentence(notch ? "A notch" : "A wedge", " at ", place_text(worst.at_m), " opens by ", worst.opening_deg,
                        " degrees, less than ", limit_deg, ".");
  return test;
}

CastingTest cables_test(const CastRobot& robot, const RayTree& tree, const CastingSettings& settings) {
  const WorstAlong bend = tightest_bend(robot.sheaths), cover = thinnest_cover(tree, robot.sheaths);
  CastingTest test{"cables", true, {}, {}, "", ""};
  test.numbers = {{"worst_radius_m", bend.worst_m},
                  {"moved_radius_m", robot.moved_bend.worst_m},
                  {"min_radius_m", settings.min_radius_m},
                  {"worst_wall_m", cover.worst_m},
                  {"min_wall_m", settings.sheath.wall_m}};
  if (bend.worst_m < settings.min_radius_m) {
    test.at_m = bend.at_m;
    test.why = sentence("Cable ", bend.cable, " bends by a radius of ", mm(bend.worst_m), " at ", place_text(bend.at_m),
                        ", where its sheath kinks below ", mm(settings.min_radius_m), ". ");
  }
  if (cover.worst_m < settings.sheath.wall_m) {
    test.at_m = cover.at_m;
    test.why += sentence("The sheath of cable ", cover.cable, " has ", mm(cover.worst_m), " of silicone at ",
                         place_text(cover.at_m), ", less than ", mm(settings.sheath.wall_m), ".");
  }
  test.passed = test.why.empty();
  return test;
}

CastingTest ligaments_test(const CastRobot& robot, const RayTree& tree, double limit_m) {
  const WorstAlong nearest = nearest_sheaths(tree, robot.sheaths);
  CastingTest test{"ligaments", nearest.worst_m >= limit_m, {}, {}, "", ""};
  test.numbers = {{"worst_m", nearest.worst_m}, {"limit_m", limit_m}};
  if (std::isfinite(nearest.worst_m)) test.at_m = nearest.at_m;
  if (!test.passed)
    test.why =
        sentence("Between the sheaths of ", nearest.cable, " and ", nearest.other, " stand ", mm(nearest.worst_m),
                 " of silicone at ", place_text(nearest.at_m), ", less than ", mm(limit_m), ".");
  return test;
}

std::string shelves_fault(const WorstAlong& steepest, const WorstAlong& nearest) {
  if (steepest.worst_m < kSteepest_deg)
    return sentence("The sheath of cable ", steepest.cable, " stands at ", steepest.worst_m,
                    " degrees to the way out, too upright for a shelf (", kSteepest_deg, ").");
  if (nearest.worst_m < 0)
    return sentence("Seen along the way out, the sheaths of ", nearest.cable, " and ", nearest.other, " overlap by ",
                    mm(-nearest.worst_m), " at ", place_text(nearest.at_m), ": no shelf can hold both.");
  return "";
}

CastingTest shelves_test(const CastRobot& robot, const Eigen::Vector3d& direction, const SheathSettings& sheath) {
  CastingTest test{"shelves", true, {}, {}, "", ""};
  if (!sheath.shelf) return test;
  const WorstAlong steepest = steepest_sheath(robot.sheaths, direction);
  const WorstAlong nearest = nearest_footprints(robot.sheaths, direction);
  test.numbers = {
      {"worst_m", nearest.worst_m}, {"limit_m", 0}, {"steepest_deg", steepest.worst_m}, {"limit_deg", kSteepest_deg}};
  test.why = shelves_fault(steepest, nearest);
  test.passed = test.why.empty();
  if (!test.passed) test.at_m = steepest.worst_m < kSteepest_deg ? steepest.at_m : nearest.at_m;
  return test;
}

CastingTest stretch_test(const Surface& surface, const Eigen::Vector3d& direction, double limit) {
  const Squeeze squeeze = needed_stretch(surface, direction);
  CastingTest test{"stretch", squeeze.stretch <= limit, {{"worst", squeeze.stretch}, {"limit", limit}}, {}, "", ""};
  if (squeeze.stretch > 1) test.at_m = squeeze.at_m;
  if (!test.passed)
    test.why = sentence("The robot is ", squeeze.stretch, " times as wide at ", place_text(squeeze.at_m),
                        " as the mould above it, more than ", limit, ".");
  return test;
}

double all_suction_n(const Pockets& pockets) {
  double force = 0;
  for (const Pocket& pocket : pockets.pockets) force += suction_n(pocket);
  return force;
}

CastingTest suction_test(const Pockets& found, const CastRobot& robot, const CastingSettings& settings) {
  const double force = all_suction_n(found);
  const double stress = force == 0 || settings.air_holes ? 0 : force / std::max(found.wall_area_m2, 1e-12);
  const double strain = stress / robot.youngs_modulus_pa;
  CastingTest test{"suction", strain <= settings.max_suction_strain, {}, {}, "", ""};
  test.numbers = {{"force_n", settings.air_holes ? 0 : force},
                  {"force_without_air_holes_n", force},
                  {"stress_pa", stress},
                  {"strain", strain},
                  {"limit_strain", settings.max_suction_strain},
                  {"pockets", static_cast<double>(found.pockets.size())},
                  {"bottom_force_n", kAtmosphere_pa * found.footprint_m2},
                  {"air_holes", settings.air_holes ? static_cast<double>(found.pockets.size()) : 0}};
  if (!found.pockets.empty()) test.at_m = found.pockets[0].at_m;
  if (test.passed) return test;
  test.cause = "vacuum under blind pockets";
  test.why =
      sentence("No air gets to the roofs of ", found.pockets.size(),
               " blind pockets while the robot is lifted: the air outside holds it with ", force, " N, ", stress / 1e6,
               " MPa in the walls beside them (a strain of ", strain, "); give the cores air holes.");
  return test;
}

CastingTest aspect_test(const Pockets& found, double limit) {
  CastingTest test{"aspect", true, {}, {}, "", ""};
  const Core slimmest = found.cores.empty() ? Core() : found.cores[0];
  const auto through = std::count_if(found.cores.begin(), found.cores.end(), [](const Core& c) { return c.through; });
  constexpr double kExact = 1 + 1e-2;  // what facets take from the width of a round hole
  test.passed = slimmest.aspect() <= limit * kExact;
  test.numbers = {{"worst", slimmest.aspect()},
                  {"limit", limit},
                  {"height_m", found.cores.empty() ? INFINITY : slimmest.height_m},
                  {"width_m", slimmest.width_m},
                  {"cores", static_cast<double>(found.cores.size())},
                  {"through_holes", static_cast<double>(through)}};
  if (!found.cores.empty()) test.at_m = slimmest.at_m;
  if (!test.passed)
    test.why = sentence("The core ", slimmest.through ? "of the hole through the robot " : "", "at ",
                        place_text(*test.at_m), " is ", slimmest.aspect(), " times as high as wide (",
                        mm(slimmest.height_m), " by ", mm(slimmest.width_m), "), more than ", limit, ".");
  return test;
}

Surface turned_inside_out(Surface surface) {
  surface.triangles.row(1).swap(surface.triangles.row(2));
  surface.neighbours.row(0).swap(surface.neighbours.row(2));
  surface.normals *= -1;
  surface.true_normals *= -1;
  return surface;
}

CastingTest walls_test(const Surface& surface, double limit_m) {
  const Surface mould = turned_inside_out(surface);
  const ThinPlace thinnest = measure_balls(RayTree(mould), limit_m);
  constexpr double kExact = 1 - 1e-3;  // as of silicone
  CastingTest test{"mould_walls", thinnest.worst_m >= limit_m * kExact, {}, {}, "", ""};
  test.numbers = {{"worst_m", thinnest.worst_m}, {"limit_m", limit_m}};
  if (std::isfinite(thinnest.worst_m)) test.at_m = thinnest.at_m;
  if (!test.passed)
    test.why = sentence("The mould would be ", mm(thinnest.worst_m), " thick between ", place_text(thinnest.at_m),
                        " and ", place_text(thinnest.opposite_m), ", less than casting.min_wall_m, ", mm(limit_m), ".");
  return test;
}

CastingTest mesh_test(const std::vector<double>& qualities) {
  const double worst = qualities.empty() ? INFINITY : *std::min_element(qualities.begin(), qualities.end());
  const auto poor = std::count_if(qualities.begin(), qualities.end(), [](double q) { return q < 0.5; });
  CastingTest test{"mesh_quality", worst > 0, {}, {}, "", ""};
  test.numbers = {{"worst", worst},
                  {"limit", 0},
                  {"elements", static_cast<double>(qualities.size())},
                  {"below_half", static_cast<double>(poor)}};
  if (!test.passed) test.why = "An element of the simulation's mesh is flat or inverted.";
  return test;
}

// Directions of faces have rounding in them, and zeros of either sign.
Eigen::Vector3d without_noise(const Eigen::Vector3d& direction) {
  return direction.unaryExpr([](double x) { return std::abs(x) < 1e-9 ? 0.0 : x; }).normalized();
}

}  // namespace

const CastingTest& CastingVerdict::test(const std::string& name) const {
  const auto found = std::find_if(tests.begin(), tests.end(), [&](const auto& t) { return t.name == name; });
  if (found == tests.end()) throw std::out_of_range("no test '" + name + "'");
  return *found;
}

Eigen::Vector3d way_out(const CastShape& shape, const CastingSettings& settings) {
  if (settings.direction) return without_noise(*settings.direction);
  const std::optional<Eigen::Vector3d> best = best_direction(shape.surface(), shape.tops);
  return without_noise(best ? *best : least_blocked_direction(shape.surface(), shape.tops));
}

CastingVerdict check_casting(const CastRobot& robot, const CastingSettings& settings) {
  const CastShape whole(robot.surface);  // what sheaths run in
  const std::optional<CastShape> shelved =
      robot.shelved ? std::optional<CastShape>(std::in_place, *robot.shelved) : std::nullopt;
  const CastShape& shape = shelved ? *shelved : whole;
  const RayTree& tree = shape.tree;
  const Surface& surface = shape.surface();
  CastingVerdict verdict;
  verdict.judged = surface;
  verdict.direction_given = settings.direction.has_value();
  verdict.direction = way_out(whole, settings);
  const Extraction out = verify_extraction(shape, verdict.direction);
  verdict.blocked = out.blocked;
  const Thickness thickness = measure_thickness(tree, settings.min_thickness_m);
  verdict.thickness_m = thickness.of_facets;
  const Pockets pockets = find_pockets(tree, verdict.direction, settings.notch_radius_m);
  verdict.tests = {
      extraction_test(out, verify_two_parts(tree, verdict.direction), verdict.direction_given, settings.min_draft_deg),
      cavities_test(surface),
      thickness_test(thickness, settings.min_thickness_m),
      angles_test(measure_angles(surface, settings.notch_radius_m, settings.min_angle_deg), settings.min_angle_deg),
      cables_test(robot, whole.tree, settings),
      ligaments_test(robot, whole.tree, settings.sheath.wall_m),
      shelves_test(robot, verdict.direction, settings.sheath),
      stretch_test(surface, verdict.direction, settings.max_stretch),
      suction_test(pockets, robot, settings),
      aspect_test(pockets, settings.max_core_aspect),
      walls_test(surface, settings.mould.min_wall_m),
      mesh_test(robot.mesh_qualities)};
  verdict.castable = std::all_of(verdict.tests.begin(), verdict.tests.end(), [](const auto& t) { return t.passed; });
  return verdict;
}

}  // namespace soft_robot_lab
