// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "fidelity.h"

namespace soft_robot_lab {
namespace {

bool skin_overlaps(const std::vector<SolveWarning>& warnings) {
  return std::any_of(warnings.begin(), warnings.end(),
                     [](const SolveWarning& warning) { return warning.kind == "skin_in_silicone"; });
}

// Empty where it found no rest state.
std::vector<Eigen::Vector3d> rest_markers_m(Simulation& simulation, const std::vector<double>& commands,
                                            std::vector<SolveWarning>* warnings) {
  for (std::size_t i = 0; i < commands.size(); ++i)
    simulation.set_command(simulation.actuators()[i]->name(), commands[i]);
  const SolveReport report = simulation.solve_equilibrium();
  if (!report.converged) return {};
  if (warnings) *warnings = report.warnings;
  std::vector<Eigen::Vector3d> markers_m;
  for (std::size_t i = 0; i < simulation.markers().size(); ++i)
    markers_m.push_back(simulation.marker_position(static_cast<int>(i)));
  return markers_m;
}

}  // namespace

Overrides self_contact() { return Overrides().set({"contact", "self"}, true); }

ContactEffect contact_effect(const YamlNode& settings, const SceneOptions& options) {
  const TetMesh mesh = read_mesh(settings, options);
  const Scene without = build_scene(settings, mesh, options);
  ContactEffect effect;
  if (without.simulation->body().touches_itself()) return effect;
  std::optional<Scene> with;
  for (const std::vector<double>& commands : judged_commands(*without.simulation, without.run)) {
    std::vector<SolveWarning> warnings;
    const auto free_m = rest_markers_m(*without.simulation, commands, &warnings);
    if (free_m.empty() || (!with && !skin_overlaps(warnings))) continue;
    if (!with) with = build_scene(self_contact().over(settings), mesh, options);
    const auto kept_out_m = rest_markers_m(*with->simulation, commands, nullptr);
    for (std::size_t i = 0; i < kept_out_m.size(); ++i) {
      const double moved_m = (free_m[i] - kept_out_m[i]).norm();
      if (moved_m > effect.moved_m) effect = {moved_m, without.simulation->markers()[i].name()};
    }
  }
  return effect;
}

}  // namespace soft_robot_lab
