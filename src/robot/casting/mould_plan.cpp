// SPDX-License-Identifier: BSD-3-Clause
#include "mould_plan.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <sstream>
#include <utility>

#include <Eigen/Geometry>

#include "build_solids.h"
#include "lid_plan.h"
#include "pockets.h"
#include "air_traps.h"

namespace soft_robot_lab {
namespace {

using Eigen::Vector3d;

constexpr double kBeyond_m = 0.001;     // what is cut away reaches this far out
constexpr double kBoltsApart_m = 0.06;  // at most
constexpr double kKeyTaper = 0.6;       // radius of a peg's end over its foot's
constexpr double kSprueFlare = 2;       // radius of a sprue's mouth over its end's
constexpr double kSprueHeight = 3;      // over the radius of its end

Vector3d exact_axis(const Vector3d& normal, const std::string& what) {
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  const Vector3d exact = (normal[axis] > 0 ? 1.0 : -1.0) * Vector3d::Unit(axis);
  if ((normal - exact).norm() < 1e-6) return exact;
  std::ostringstream text;
  text << what << " [" << normal.transpose()
       << "] lies along none of the robot's axes: a block is made along these alone";
  throw NoMould(text.str());
}

void forget_names(Solid& solid) {
  solid.name.clear();
  for (Solid& part : solid.parts) forget_names(part);
}

[[noreturn]] void refuse_facets(const std::string& key, const std::string& what) {
  throw std::invalid_argument(key + ": a mould is cut from a block with the robot's own curved sides, and " + what +
                              " has flat facets alone; export the body as STEP from the program that drew it, and give "
                              "it by `solid: {step: FILE.step}`, or describe it by shapes. check_casting takes facets");
}

Solid robot_solid(const CastRobotFile& file) {
  if (!file.solid) refuse_facets("body.mesh", "a mesh");
  Solid solid = *file.solid;
  if (holds_stl(solid)) refuse_facets("body.solid: stl", "an STL file");
  forget_names(solid);
  return solid;
}

// Failed tests but these.
std::string reasons(const CastingVerdict& verdict, const std::set<std::string>& forgiven) {
  std::string all;
  for (const CastingTest& test : verdict.tests)
    if (!test.passed && forgiven.count(test.name) == 0) all += (all.empty() ? "" : " ") + test.name + ": " + test.why;
  return all;
}

void take_box(const Surface& surface, MouldPlan& plan) {
  const Eigen::Matrix3Xd places = plan.frame.transpose() * surface.vertices_m;
  plan.low_m = places.rowwise().minCoeff();
  plan.high_m = places.rowwise().maxCoeff();
}

double box_volume(const Vector3d& low_m, const Vector3d& high_m) { return (high_m - low_m).prod(); }

double cone_volume(double height_m, double r, double s) { return M_PI / 3 * height_m * (r * r + r * s + s * s); }

// --- one part ---

void add_air_holes(const RayTree& tree, const CastingSettings& settings, MouldPlan& plan) {
  if (!settings.air_holes) return;
  const Vector3d up = plan.frame.col(2);
  const double floor_m = plan.low_m.z() - settings.mould.wall_m;
  for (const Pocket& pocket : find_pockets(tree, plan.direction, settings.notch_radius_m).pockets) {
    const double length = (up.dot(pocket.at_m) - floor_m) / up.dot(plan.direction);
    plan.block_volume_m3 -= M_PI * std::pow(settings.mould.air_hole_radius_m, 2) * length;
    plan.air_holes.push_back({pocket.at_m, pocket.at_m - (length + kBeyond_m) * plan.direction});
  }
}

// Up to the top of the block, so that slots end in its plane; down through its floor's upper side.
void lay_sheaths(const CastRobotFile& file, const Solid& solid, MouldPlan& plan) {
  plan.sheaths = pieces_on_shelves(file);
  MouldHeights heights = heights_along(file.robot.surface, plan.direction);
  plan.flash_m3 = flash_m3(plan.sheaths, plan.direction, heights, file.settings.sheath.clearance_m);
  heights.floor_m -= kBeyond_m;
  plan.cast = cast_on_shelves(solid, plan.sheaths, plan.direction, heights, file.settings.sheath.clearance_m);
}

MouldPlan plan_one_part(const CastRobotFile& file, const CastShape& robot, const Solid& solid,
                        const CastingVerdict& verdict) {
  const CastingSettings& settings = file.settings;
  const Extraction out = verify_extraction(robot, verdict.direction);
  MouldPlan plan;
  plan.direction = verdict.direction;
  plan.top_area_m2 = out.top_area_m2;
  plan.frame = frame_along(exact_axis(out.top_normal, "the open top's normal"));
  take_box(robot.surface(), plan);
  lay_sheaths(file, solid, plan);
  const Vector3d wall = Vector3d::Constant(settings.mould.wall_m);
  const Vector3d low = plan.low_m - wall, high = plan.high_m + Vector3d(wall.x(), wall.y(), 0);
  plan.block_volume_m3 = box_volume(low, high);
  add_air_holes(robot.tree, settings, plan);
  std::vector<Solid> parts{block(plan.frame, low, high), plan.cast};
  for (const AirHole& hole : plan.air_holes)
    parts.push_back(round_bar(hole.from_m, hole.to_m, settings.mould.air_hole_radius_m));
  plan.rim_m = plan.high_m.z();
  plan.pieces = {
      {"mould", combined(Solid::Kind::difference, parts), plan.frame.transpose(), high - low, plan.low_m, plan.high_m}};
  return plan;
}

// --- two parts ---

struct Skin {
  double down_m = -INFINITY, up_m = INFINITY;  // the highest point that faces down, the lowest that faces up

  void add(double cosine, double height_m) {
    if (cosine < 0) down_m = std::max(down_m, height_m);
    if (cosine > 0) up_m = std::min(up_m, height_m);
  }
};

Skin facing(const Surface& surface, const Vector3d& direction) {
  const double tolerance = std::sin(0.1 * M_PI / 180);
  Skin skin;
  for (int t = 0; t < surface.triangle_count(); ++t) {
    const double cosine = surface.true_normals.col(t).dot(direction);
    if (std::abs(cosine) <= tolerance || surface.areas_m2[t] == 0) continue;
    if (surface.is_curved(t))
      skin.add(cosine, direction.dot(surface.centre(t)));  // where its normal is
    else
      for (int i = 0; i < 3; ++i) skin.add(cosine, direction.dot(surface.corner(t, i)));
  }
  return skin;
}

// The plane halves what is free, where the robot's middle is not.
std::optional<double> parting_offset(const Surface& surface, const Vector3d& direction) {
  const Skin skin = facing(surface, direction);
  const double tolerance_m = 1e-7 * surface.size_m();
  if (skin.down_m > skin.up_m + tolerance_m) return std::nullopt;
  const Eigen::RowVectorXd heights = direction.transpose() * surface.vertices_m;
  const double middle = (heights.minCoeff() + heights.maxCoeff()) / 2;
  if (skin.up_m - skin.down_m < tolerance_m) return (skin.down_m + skin.up_m) / 2;
  return std::clamp(middle, skin.down_m, skin.up_m);
}

// The parts of cores that stand on one half, up to the parting plane.
void require_short_cores(const RayTree& tree, const Parting& parting, const CastingSettings& settings) {
  for (const double sign : {1.0, -1.0}) {
    const Pockets found =
        find_pockets(tree, sign * parting.direction, settings.notch_radius_m, sign * parting.offset_m);
    if (found.cores.empty() || found.cores[0].aspect() <= settings.max_core_aspect) continue;
    std::ostringstream text;
    text << "the core of a half at " << place_text(found.cores[0].at_m) << " would be " << found.cores[0].aspect()
         << " times as high as wide, more than casting.max_core_aspect, " << settings.max_core_aspect;
    throw NoMould(text.str());
  }
}

void require_no_pockets(const RayTree& tree, const Vector3d& direction, const CastingSettings& settings) {
  for (const double sign : {1.0, -1.0}) {
    const Pockets found = find_pockets(tree, sign * direction, settings.notch_radius_m);
    if (found.pockets.empty()) continue;
    throw NoMould("a half of the mould would hold the robot by a vacuum in the pocket at " +
                  place_text(found.pockets[0].at_m) + "; air holes are made in moulds of one part alone");
  }
}

// Places along the flange, from its lower end: bolts, with a key between each two.
struct FlangePlaces {
  std::vector<double> bolts_m, keys_m;
};

FlangePlaces flange_places(double low_m, double high_m, const MouldSettings& mould) {
  const double first = low_m + mould.flange_m / 2, length = high_m - low_m - mould.flange_m;
  const double least = 2 * (mould.bolt_radius_m + mould.key_radius_m + mould.clearance_m + mould.min_wall_m);
  if (length < least) throw NoMould("the mould is too low for bolts and keys; smaller flange_m may help");
  const int gaps = std::max(1, static_cast<int>(std::ceil(length / kBoltsApart_m)));
  FlangePlaces places;
  for (int i = 0; i <= gaps; ++i) places.bolts_m.push_back(first + length * i / gaps);
  for (int i = 0; i < gaps; ++i) places.keys_m.push_back(first + length * (i + 0.5) / gaps);
  return places;
}

struct Flanged {
  Vector3d low, high;                // of the block
  Vector3d flange_low, flange_high;  // of both flanges, in one piece with it
  std::vector<Solid> bolts, pegs, sockets;
};

void check_flange(const MouldSettings& mould) {
  const double widest = std::max(mould.bolt_radius_m, mould.key_radius_m + mould.clearance_m);
  if (mould.flange_m < 2 * (widest + mould.min_wall_m))
    throw NoMould("flange_m leaves less than min_wall_m beside bolts or keys");
  if (mould.wall_m / 2 < mould.min_wall_m + mould.clearance_m)
    throw NoMould("wall_m leaves less than min_wall_m below the keys, which are half as high");
}

Flanged make_flanges(const MouldSettings& mould, MouldPlan& plan) {
  check_flange(mould);
  const Eigen::Matrix3d& frame = plan.frame;
  const Vector3d wall = Vector3d::Constant(mould.wall_m);
  Flanged made;
  made.low = plan.low_m - wall;
  made.high = plan.high_m + wall;
  made.high.z() = plan.rim_m;
  made.flange_low = {made.low.x() - mould.flange_m, plan.parting_m - mould.wall_m, made.low.z()};
  made.flange_high = {made.high.x() + mould.flange_m, plan.parting_m + mould.wall_m, made.high.z()};
  const FlangePlaces places = flange_places(made.low.z(), made.high.z(), mould);
  const double key_height = mould.wall_m / 2;
  for (const double x : {made.low.x() - mould.flange_m / 2, made.high.x() + mould.flange_m / 2}) {
    for (const double z : places.bolts_m) {
      const Vector3d at(x, plan.parting_m, z), reach(0, mould.wall_m + kBeyond_m, 0);
      made.bolts.push_back(round_bar(frame * (at - reach), frame * (at + reach), mould.bolt_radius_m));
    }
    for (const double z : places.keys_m) {
      const Vector3d at(x, plan.parting_m, z), y = Vector3d::UnitY();
      const double r = mould.key_radius_m, c = mould.clearance_m;
      made.pegs.push_back(round_bar(frame * at, frame * (at + key_height * y), r, kKeyTaper * r));
      made.sockets.push_back(round_bar(frame * at, frame * (at + (key_height + c) * y), r + c, kKeyTaper * r + c));
    }
  }
  return made;
}

double flanged_volume(const Flanged& made, const MouldSettings& mould, const MouldPlan& plan) {
  const double half_low = plan.parting_m - std::min(made.low.y(), made.flange_low.y());
  const double half_high = std::max(made.high.y(), made.flange_high.y()) - plan.parting_m;
  const double across = (made.high.x() - made.low.x()) * (half_low + half_high);
  const double beside = 2 * mould.flange_m * 2 * mould.wall_m;
  const double r = mould.key_radius_m, c = mould.clearance_m, h = mould.wall_m / 2;
  const double peg = cone_volume(h, r, kKeyTaper * r), socket = cone_volume(h + c, r + c, kKeyTaper * r + c);
  const double bolt = 2 * mould.wall_m * M_PI * std::pow(mould.bolt_radius_m, 2);
  return (across + beside) * (made.high.z() - made.low.z()) - static_cast<double>(made.bolts.size()) * bolt +
         static_cast<double>(made.pegs.size()) * (peg - socket);
}

// From the parting plane to its outer side, block and flanges.
std::vector<Solid> half_blocks(const Flanged& made, const MouldPlan& plan, bool upper) {
  Vector3d low = made.low, high = made.high, flange_low = made.flange_low, flange_high = made.flange_high;
  (upper ? low : high).y() = (upper ? flange_low : flange_high).y() = plan.parting_m;
  if (upper) high.y() = std::max(high.y(), flange_high.y());
  if (!upper) low.y() = std::min(low.y(), flange_low.y());
  return {block(plan.frame, low, high), block(plan.frame, flange_low, flange_high)};
}

// Pegs are lower than the flange is thick, but stand above the lower half.
Vector3d half_size(const Flanged& made, const MouldPlan& plan, bool upper) {
  const double low = std::min(made.low.y(), made.flange_low.y()), high = std::max(made.high.y(), made.flange_high.y());
  const double across = upper ? high - plan.parting_m : plan.parting_m - low;
  return {made.flange_high.x() - made.flange_low.x(), across, made.high.z() - made.low.z()};
}

MouldPiece half(const Flanged& made, const MouldPlan& plan, bool upper) {
  std::vector<Solid> rest{combined(Solid::Kind::union_of, half_blocks(made, plan, upper)), plan.cast};
  rest.insert(rest.end(), made.bolts.begin(), made.bolts.end());
  if (upper) rest.insert(rest.end(), made.sockets.begin(), made.sockets.end());
  Solid solid = combined(Solid::Kind::difference, rest);
  if (!upper) {
    std::vector<Solid> all{solid};
    all.insert(all.end(), made.pegs.begin(), made.pegs.end());
    solid = combined(Solid::Kind::union_of, all);
  }
  // On the bed with the parting plane up.
  Eigen::Matrix3d to_print;
  const double sign = upper ? -1 : 1;
  to_print.row(1) = plan.frame.col(2).transpose();
  to_print.row(2) = sign * plan.frame.col(1).transpose();
  to_print.row(0) = to_print.row(1).cross(to_print.row(2));
  const Vector3d form_high(plan.high_m.x(), plan.high_m.y(), plan.rim_m);
  return {upper ? "upper_half" : "lower_half", solid, to_print, half_size(made, plan, upper), plan.low_m, form_high};
}

// --- ways for air and silicone ---

double channel_m3(const Channel& channel) {
  return cone_volume((channel.to_m - channel.from_m).norm(), channel.radius_m, channel.end_radius_m);
}

// Up to the rim, or to silicone above.
Channel channel_over(const AirTrap& trap, const MouldPlan& plan, double radius_m, double end_radius_m) {
  const auto at = [&](double height_m) -> Vector3d {
    return plan.frame * Vector3d(trap.across_m, plan.parting_m, height_m);
  };
  return {at(trap.height_m), at(std::min(trap.above_m, plan.rim_m)), radius_m, end_radius_m};
}

// It begins a little inside the cavity, as a round skin falls off around its highest place.
Solid bar_of(const Channel& channel, const Vector3d& up, bool ends_in_silicone) {
  const Vector3d begin = channel.from_m - kBeyond_m * up, end = channel.to_m + (ends_in_silicone ? kBeyond_m : 0) * up;
  if (channel.radius_m == channel.end_radius_m) return round_bar(begin, end, channel.radius_m);
  return combined(Solid::Kind::union_of, {round_bar(begin, channel.from_m, channel.radius_m),
                                          round_bar(channel.from_m, end, channel.radius_m, channel.end_radius_m)});
}

double sprue_height_m(const MouldSettings& mould) {
  return std::max(mould.wall_m, kSprueHeight * mould.sprue_radius_m);
}

// The rim lies above the robot where it has no open side.
void add_channels(const std::vector<AirTrap>& traps, const Solid& robot, const MouldSettings& mould, MouldPlan& plan) {
  const Vector3d up = plan.frame.col(2);
  std::vector<Solid> filled{robot};
  for (const AirTrap& trap : traps) {
    if (trap.height_m > plan.rim_m - kBeyond_m) continue;  // open to air
    if (plan.rim_m > plan.high_m.z() && !plan.sprue) {
      plan.sprue = channel_over(trap, plan, mould.sprue_radius_m, kSprueFlare * mould.sprue_radius_m);
      filled.push_back(bar_of(*plan.sprue, up, false));
      continue;
    }
    plan.vents.push_back(channel_over(trap, plan, mould.air_hole_radius_m, mould.air_hole_radius_m));
    filled.push_back(bar_of(plan.vents.back(), up, trap.above_m < plan.rim_m));
  }
  plan.cast = filled.size() > 1 ? combined(Solid::Kind::union_of, filled) : robot;
}

// A closed mould stands so that least air is caught in it, then so that it is high.
Vector3d best_up(const RayTree& tree, const Parting& parting) {
  Vector3d best = Vector3d::Zero();
  std::pair<size_t, double> least{SIZE_MAX, 0};
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(parting.direction[axis]) > 0.5) continue;
    const MouldHeights heights = heights_along(tree.surface(), Vector3d::Unit(axis));
    for (const double sign : {1.0, -1.0}) {
      const Vector3d up = sign * Vector3d::Unit(axis);
      Eigen::Matrix3d frame;
      frame << parting.direction.cross(up), parting.direction, up;
      const std::pair<size_t, double> worth{find_air_traps(tree, frame, parting.offset_m).size(),
                                            heights.floor_m - heights.top_m};
      if (worth < least) least = worth, best = up;
    }
  }
  return best;
}

void require_room_for_sprue(const Flanged& made, const MouldSettings& mould, const MouldPlan& plan) {
  if (!plan.sprue) return;
  const double needed = kSprueFlare * mould.sprue_radius_m + mould.min_wall_m,
               at = plan.frame.col(0).dot(plan.sprue->to_m);
  const double room =
      std::min({plan.parting_m - made.low.y(), made.high.y() - plan.parting_m, at - made.low.x(), made.high.x() - at});
  if (room < needed) throw NoMould("the block has no room for the sprue's mouth; a smaller sprue_radius_m may help");
}

MouldPlan plan_two_parts(const CastShape& robot, const Solid& solid, const CastingSettings& settings) {
  const RayTree& tree = robot.tree;
  const Parting parting = find_parting(robot);
  require_no_pockets(tree, parting.direction, settings);
  require_short_cores(tree, parting, settings);
  MouldPlan plan;
  plan.two_part = true;
  plan.direction = parting.direction;
  plan.top_area_m2 = parting.top ? parting.top->area_m2 : 0;
  const Vector3d up = parting.top ? exact_axis(parting.top->normal, "the open top's normal") : best_up(tree, parting);
  plan.frame << parting.direction.cross(up), parting.direction, up;
  plan.parting_m = parting.offset_m;
  take_box(robot.surface(), plan);
  plan.rim_m = plan.high_m.z() + (parting.top ? 0 : sprue_height_m(settings.mould));
  add_channels(find_air_traps(tree, plan.frame, plan.parting_m), solid, settings.mould, plan);
  const Flanged made = make_flanges(settings.mould, plan);
  require_room_for_sprue(made, settings.mould, plan);
  plan.bolts = static_cast<int>(made.bolts.size());
  plan.keys = static_cast<int>(made.pegs.size());
  plan.block_volume_m3 = flanged_volume(made, settings.mould, plan);
  for (const Channel& vent : plan.vents) plan.flash_m3 += channel_m3(vent);
  if (plan.sprue) plan.flash_m3 += channel_m3(*plan.sprue);
  plan.pieces = {half(made, plan, false), half(made, plan, true)};
  return plan;
}

void require_printable(const MouldPlan& plan, const MouldSettings& mould) {
  for (const MouldPiece& piece : plan.pieces) {
    if (fits_printer(piece.size_m, mould.printer_m)) continue;
    std::ostringstream text;
    text << piece.name << " of " << 1000 * piece.size_m.transpose() << " mm does not fit the printer of "
         << 1000 * mould.printer_m.transpose() << " mm; a larger casting.printer_m would do";
    throw NoMould(text.str());
  }
}

void judge_one_part(const CastRobotFile& file, const CastShape& robot, const Solid& solid, JudgedMould& judged) {
  CastingTest made{"mould", true, {}, {}, "", "", ""};
  try {
    judged.plan = plan_one_part(file, robot, solid, judged.verdict);
    require_printable(*judged.plan, file.settings.mould);
  } catch (const NoMould& reason) {
    judged.plan.reset();
    judged.verdict.castable = made.passed = false;
    made.why = std::string("The robot would leave its mould, but this program makes none: ") + reason.what() + ".";
  }
  judged.verdict.tests.push_back(made);
}

// A kind of mould that a failed test may pass with.
struct MouldKind {
  std::string test, key, words;
  bool allowed;
};

template <typename Plan>
void judge_kind(const CastRobotFile& file, const MouldKind& kind, const Plan& plan, JudgedMould& judged) {
  const auto failed = [&](const CastingTest& test) { return test.name == kind.test; };
  std::string& why = std::find_if(judged.verdict.tests.begin(), judged.verdict.tests.end(), failed)->why;
  try {
    MouldPlan made = plan();
    require_printable(made, file.settings.mould);
    why += " A mould " + kind.words + " is made with casting: {allow: [" + kind.key + "]} or make_mould --allow " +
           kind.key + ".";
    if (!kind.allowed) return;
    judged.plan = std::move(made);
    for (CastingTest& test : judged.verdict.tests)
      if (!test.passed) test.passed = true, test.by = kind.key;
    judged.verdict.castable = true;
  } catch (const NoMould& reason) {
    why += " This program makes no mould " + kind.words + " of it: " + reason.what() + ".";
  }
}

}  // namespace

bool fits_printer(Vector3d size_m, Vector3d room_m) {
  std::sort(size_m.data(), size_m.data() + 3);
  std::sort(room_m.data(), room_m.data() + 3);
  return (size_m.array() <= room_m.array() + 1e-9).all();
}

Parting find_parting(const CastShape& robot) {
  const Surface& surface = robot.surface();
  const std::vector<HullPlane>& tops = robot.tops;
  std::optional<Parting> best;
  double least_m = INFINITY;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d direction = Vector3d::Unit(axis);
    const std::optional<double> offset = parting_offset(surface, direction);
    if (!offset) continue;
    const auto top = std::find_if(tops.begin(), tops.end(), [&](const HullPlane& plane) {
      return std::abs(plane.normal.dot(direction)) < 1e-6 && plane.normal.cwiseAbs().maxCoeff() > 1 - 1e-9;
    });
    const bool open = top != tops.end();
    const double depth_m = surface.vertices_m.row(axis).maxCoeff() - surface.vertices_m.row(axis).minCoeff();
    if (best && (best->top.has_value() > open || (best->top.has_value() == open && depth_m >= least_m))) continue;
    least_m = depth_m;
    best = Parting{direction, *offset, open ? std::optional<HullPlane>(*top) : std::nullopt};
  }
  if (best) return *best;
  throw NoMould(
      "no flat plane across one of its axes has all skin that faces up above it and all that faces down below it; what "
      "reaches across such a plane, as a core on the upper half, a stepped parting or side cores, is not made");
}

JudgedMould judge_mould(const CastRobotFile& file, CastingVerdict verdict) {
  const Solid solid = robot_solid(file);
  const CastShape robot(file.robot.surface);
  JudgedMould judged{std::move(verdict), std::nullopt};
  if (judged.verdict.castable) {
    judge_one_part(file, robot, solid, judged);
  } else if (!reasons(judged.verdict, {"cavities", "extraction", "stretch", "suction", "aspect"}).empty()) {
    // No kind of mould mends what else fails.
  } else if (!judged.verdict.test("cavities").passed) {
    judge_kind(
        file, {"cavities", "lid", "with a lid", file.settings.mould.allow_lid}, [&] { return plan_lid(file, solid); },
        judged);
  } else if (!judged.verdict.test("extraction").passed) {
    judge_kind(
        file, {"extraction", "two_part", "of two halves", file.settings.mould.allow_two_part},
        [&] { return plan_two_parts(robot, solid, file.settings); }, judged);
  }
  return judged;
}

MouldPlan plan_mould(const CastRobotFile& file, const CastingVerdict& verdict) {
  JudgedMould judged = judge_mould(file, verdict);
  if (!judged.plan) throw NoMould(reasons(judged.verdict, {}));
  return *std::move(judged.plan);
}

CastingVerdict with_allowed_moulds(const CastRobotFile& file, CastingVerdict verdict) {
  return !file.solid || holds_stl(*file.solid) ? verdict : judge_mould(file, std::move(verdict)).verdict;
}

}  // namespace soft_robot_lab
