// SPDX-License-Identifier: BSD-3-Clause
// What parts of a scene change at its judged states: each is switched off, or on, once.
#include <algorithm>

#include "fidelity.h"
#include "mechanics/reduced/snapshots.h"

namespace soft_robot_lab {
namespace {

struct OptionalPart {
  std::string name;
  Overrides off;
  bool at_rest = true;  // whether it can change a rest state
};

std::string place(std::size_t i) { return "[" + std::to_string(i) + "]"; }

// Coefficients of contact, of which one is not zero.
std::optional<Overrides> without_friction_of_contact(const YamlNode& contact) {
  Overrides off;
  bool rubs = false;
  const std::optional<YamlNode> all = contact.optional_child("friction");
  if (all && all->is_scalar()) rubs = all->as_number() > 0.0;
  if (all && !all->is_scalar())
    for (const YamlNode& pair : all->items()) rubs = pair.number("coefficient") > 0.0 || rubs;
  if (all) off.set({"contact", "friction"}, 0.0);
  const std::vector<YamlNode> obstacles = contact.optional_sequence("obstacles");
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    if (!obstacles[i].has("friction")) continue;
    rubs = obstacles[i].number("friction") > 0.0 || rubs;
    off.set({"contact", "obstacles", place(i), "friction"}, 0.0);
  }
  if (!rubs) return std::nullopt;
  return off;
}

void add_contact(const YamlNode& contact, std::vector<OptionalPart>& parts) {
  const bool listed = contact.has("friction") && !contact.child("friction").is_scalar();  // by names of what goes
  const auto without = [&](const char* name, const std::vector<std::string>& keys) {
    OptionalPart part{name, {}, true};
    for (const std::string& key : keys)
      if (contact.has(key)) part.off.set({"contact", key}, std::vector<OverrideValue>{});
    if (listed) part.off.set({"contact", "friction"}, 0.0);
    return part;
  };
  if (!contact.optional_sequence("obstacles").empty()) parts.push_back(without("obstacles", {"obstacles"}));
  if (contact.boolean_or("self", false) || !contact.optional_sequence("bodies").empty()) {
    parts.push_back(without("contact of skin with skin", {"bodies"}));
    if (contact.has("self")) parts.back().off.set({"contact", "self"}, false);
  }
  if (std::optional<Overrides> off = without_friction_of_contact(contact))
    parts.push_back({"friction of contact", *off, true});
}

void add_friction_of_cables(const YamlNode& scene, std::vector<OptionalPart>& parts) {
  OptionalPart part{"friction of cables", {}, true};
  const std::vector<YamlNode> cables = scene.optional_sequence("cables");
  for (std::size_t i = 0; i < cables.size(); ++i)
    if (cables[i].has("friction_coefficient") && cables[i].number("friction_coefficient") > 0.0)
      part.off.set({"cables", place(i), "friction_coefficient"}, 0.0);
  if (!part.off.empty()) parts.push_back(part);
}

void add_losses(const YamlNode& body, std::vector<OptionalPart>& parts) {
  if (body.has("hysteresis") && body.child("hysteresis").number("stiffness_ratio") > 0.0)
    parts.push_back({"hysteresis", Overrides().set({"body", "hysteresis", "stiffness_ratio"}, 0.0), false});
  OptionalPart damping{"damping", {}, false};
  if (const std::optional<YamlNode> node = body.optional_child("damping"))
    for (const char* key : {"rayleigh_mass_per_s", "rayleigh_stiffness_s"})
      if (node->has(key) && node->number(key) > 0.0) damping.off.set({"body", "damping", key}, 0.0);
  if (!damping.off.empty()) parts.push_back(damping);
}

std::vector<OptionalPart> optional_parts(const YamlNode& settings) {
  const YamlNode scene = Overrides().over(settings);  // a copy: looking is not reading
  std::vector<OptionalPart> parts;
  if (const std::optional<YamlNode> contact = scene.optional_child("contact")) add_contact(*contact, parts);
  add_friction_of_cables(scene, parts);
  add_losses(scene.child("body"), parts);
  return parts;
}

// The marker that differs most.
void compare(const std::vector<Eigen::Matrix3Xd>& a, const std::vector<Eigen::Matrix3Xd>& b,
             const std::vector<YamlNode>& markers, PartEffect& effect) {
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    Eigen::Index marker = 0;
    const double moved_m = (a[i] - b[i]).colwise().norm().maxCoeff(&marker);
    if (moved_m <= effect.moved_m) continue;
    effect.moved_m = moved_m;
    effect.marker = markers[static_cast<std::size_t>(marker)].text("name");
  }
}

// Markers of the rest states that were judged with all parts, in their order; those before the first that is not found.
std::vector<Eigen::Matrix3Xd> rest_markers(const YamlNode& settings, const TetMesh& mesh, const JudgedRests& rests,
                                           Judgement& judgement, std::string& trouble) {
  Scene scene = build_scene(settings, mesh, judgement.options);
  const JudgedRests without = judged_rests(scene, {}, judgement);
  if (without.numbers != rests.numbers)
    trouble = without.trouble.empty() ? "other rest states were found without it" : "without it " + without.trouble;
  return without.numbers == rests.numbers ? without.markers_m : std::vector<Eigen::Matrix3Xd>{};
}

PartEffect effect_of(const OptionalPart& part, const YamlNode& settings, const TetMesh& mesh, const JudgedRests& rests,
                     const std::vector<Eigen::Matrix3Xd>& motion, Judgement& judgement) {
  PartEffect effect;
  effect.part = part.name;
  try {
    const YamlNode without = part.off.over(settings);
    const std::vector<YamlNode> markers = without.optional_sequence("markers");
    if (part.at_rest)
      compare(rests.markers_m, rest_markers(without, mesh, rests, judgement, effect.trouble), markers, effect);
    if (!motion.empty() && effect.trouble.empty())
      compare(motion, judged_motion(without, mesh, judgement, effect.trouble), markers, effect);
  } catch (const std::invalid_argument& error) {
    effect.trouble = std::string("the scene cannot do without it: ") + error.what();
  }
  return effect;
}

}  // namespace

Overrides self_contact() { return Overrides().set({"contact", "self"}, true); }

std::vector<PartEffect> part_effects(const YamlNode& settings, const TetMesh& mesh, const JudgedRests& rests,
                                     Judgement& judgement) {
  std::vector<PartEffect> effects;
  const std::vector<OptionalPart> parts = optional_parts(settings);
  if (parts.empty()) return effects;
  std::vector<Eigen::Matrix3Xd> motion;
  std::string trouble;
  if (moves(judgement.use)) motion = judged_motion(settings, mesh, judgement, trouble);
  for (const OptionalPart& part : parts) effects.push_back(effect_of(part, settings, mesh, rests, motion, judgement));
  return effects;
}

std::optional<PartEffect> contact_effect(const YamlNode& settings, const TetMesh& mesh, const JudgedRests& rests,
                                         Judgement& judgement) {
  const auto overlap = [](bool overlaps) { return overlaps; };
  if (std::none_of(rests.skin_overlaps.begin(), rests.skin_overlaps.end(), overlap)) return std::nullopt;
  Scene with = build_scene(self_contact().over(settings), mesh, judgement.options);
  const SolveCost cost = solve_cost(*with.simulation->model());
  const std::vector<YamlNode> markers = Overrides().over(settings).optional_sequence("markers");
  PartEffect effect;
  effect.part = "contact of skin with skin";
  bool met = false;  // contact changes nothing before it begins
  for (std::size_t i = 0; i < rests.states.size(); ++i) {
    met = met || rests.skin_overlaps[i];
    if (!met) continue;
    command(rests.states[i].commands(), *with.simulation);
    const SolveReport report = with.simulation->solve_equilibrium();
    judgement.count(cost, report);
    if (!report.converged) continue;
    compare({rests.markers_m[i]}, {positions_of(with.simulation->markers(), with.simulation->state().positions_m)},
            markers, effect);
  }
  return effect;
}

}  // namespace soft_robot_lab
