// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "fidelity.h"
#include "mechanics/reduced/snapshots.h"
#include "scene_motion.h"

namespace soft_robot_lab {
namespace {

bool skin_overlaps(const std::vector<SolveWarning>& warnings) {
  return std::any_of(warnings.begin(), warnings.end(),
                     [](const SolveWarning& warning) { return warning.kind == "skin_in_silicone"; });
}

SolveReport settle(Simulation& simulation, const std::vector<double>& commands) {
  command(commands, simulation);
  return simulation.solve_equilibrium();
}

Eigen::Matrix3Xd markers_m(Simulation& simulation) { return SceneMotion(simulation, nullptr).markers_m(); }

}  // namespace

Overrides self_contact() { return Overrides().set({"contact", "self"}, true); }

ContactEffect contact_effect(const YamlNode& settings, const SceneOptions& options) {
  const TetMesh mesh = read_mesh(settings, options);
  const Scene without = build_scene(settings, mesh, options);
  ContactEffect effect;
  if (without.simulation->body().touches_itself()) return effect;
  std::optional<Scene> with;
  for (const std::vector<double>& commands : judged_commands(*without.simulation, without.run)) {
    const SolveReport report = settle(*without.simulation, commands);
    if (!report.converged || (!with && !skin_overlaps(report.warnings))) continue;
    if (!with) with = build_scene(self_contact().over(settings), mesh, options);
    if (!settle(*with->simulation, commands).converged) continue;
    Eigen::Index marker = 0;
    const double moved_m =
        (markers_m(*without.simulation) - markers_m(*with->simulation)).colwise().norm().maxCoeff(&marker);
    if (moved_m > effect.moved_m)
      effect = {moved_m, without.simulation->markers()[static_cast<std::size_t>(marker)].name()};
  }
  return effect;
}

}  // namespace soft_robot_lab
