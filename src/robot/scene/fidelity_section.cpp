// SPDX-License-Identifier: BSD-3-Clause
#include "fidelity.h"

namespace soft_robot_lab {
namespace {

// A key that the choice would override may come from a file that the scene includes, but not stand beside `fidelity`,
// nor in a file that includes it.
void refuse_chosen(const YamlNode& scene, const YamlNode& fidelity, const std::string& section,
                   const std::vector<std::string>& keys) {
  if (!scene.has(section)) return;
  const YamlNode node = scene.child(section);
  for (const std::string& key : keys) {
    if (!node.has(key)) continue;
    const YamlNode chosen = node.child(key);
    if (chosen.source() != fidelity.source() && chosen.source() != scene.source()) continue;
    chosen.fail("is chosen by fidelity (" + fidelity.source() + "); leave out one of the two");
  }
}

// As the run says, where nothing else is asked for.
FidelityUse read_use(const YamlNode& scene, const YamlNode& fidelity) {
  const std::optional<YamlNode> run = scene.optional_child("run");
  const bool dynamic = run && run->text_or("mode", "equilibrium") == "dynamic";
  const std::string use = fidelity.choice_or("use", dynamic ? "motion" : "rest", {"rest", "motion", "search", "live"});
  for (const FidelityUse known : {FidelityUse::motion, FidelityUse::search, FidelityUse::live})
    if (use == name_of(known)) return known;
  return FidelityUse::rest;
}

}  // namespace

std::optional<FidelityRequest> read_fidelity(const YamlNode& scene) {
  const std::optional<YamlNode> node = scene.optional_child("fidelity");
  if (!node) return std::nullopt;
  FidelityRequest request;
  request.tolerance_m = node->number("tolerance_m", AllowedRange::positive());
  request.max_nodes = node->integer_or("max_nodes", request.max_nodes, 100, 20000);
  request.use = read_use(scene, *node);
  if (node->has("real_time") && request.use != FidelityUse::live)
    node->child("real_time").fail("is for use: live; leave it out, or say use: live");
  request.real_time = node->number_or("real_time", request.real_time, {0.01, 1000.0});
  if (scene.has("bodies"))
    scene.child("bodies").fail("fidelity chooses the mesh of one body; leave out one of the two");
  refuse_chosen(scene, *node, "solver", {"method", "integrator", "time_step_s", "substeps", "iterations"});
  refuse_chosen(scene, *node, "body", {"element", "element_size_m"});
  return request;
}

}  // namespace soft_robot_lab
