// SPDX-License-Identifier: BSD-3-Clause
#include "drawn_rest_states.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>

#include "drawn_scenes.h"
#include "settings/cpu_time.h"

namespace soft_robot_lab {
namespace {

constexpr double kFiner = 5.0;  // times: the steps in time that judge those that are apart

std::unique_ptr<Simulation> load(const DrawnScene& scene, double share_of_loads, const Overrides& overrides,
                                 const ExperimentContext& context) {
  return load_scene(YamlNode::parse(scene.text(share_of_loads), "drawn scene"), context.scene_options(overrides))
      .simulation;
}

void give_commands(const DrawnScene& scene, double share, Simulation& simulation) {
  for (const auto& [name, value] : scene.commands) simulation.set_command(name, 1.0 + share * (value - 1.0));
}

double largest_way_m(const Simulation& simulation, const Eigen::Matrix3Xd& from_m) {
  return (simulation.state().positions_m - from_m).colwise().norm().maxCoeff();
}

// Steps in which the loads grow with all else; each is made by a simulation of its own.
std::unique_ptr<Simulation> bring_slowly(const DrawnScene& scene, const DrawnSettings& settings,
                                         const ExperimentContext& context, JudgedScene& judged) {
  const Overrides damped = Overrides()
                               .set({"body", "damping", "rayleigh_mass_per_s"}, settings.rayleigh_mass_per_s)
                               .set({"solver", "integrator"}, "implicit_euler")
                               .set({"solver", "time_step_s"}, settings.time_step_s);
  const int steps = std::max(1, static_cast<int>(std::lround(settings.motion_s / settings.time_step_s)));
  std::unique_ptr<Simulation> simulation;
  for (int i = 1; i <= steps; ++i) {
    const double share = static_cast<double>(i) / steps;
    std::unique_ptr<Simulation> next = load(scene, share, damped, context);
    if (simulation) next->set_state(simulation->state());
    simulation = std::move(next);
    give_commands(scene, share, *simulation);
    const SolveReport report = simulation->step();
    if (!report.converged) judged.failed = "in time: " + report.message;
  }
  return simulation;
}

// Whether it came to rest.
bool let_settle(const DrawnSettings& settings, Simulation& simulation, JudgedScene& judged) {
  const int steps = std::max(1, static_cast<int>(std::lround(settings.still_for_s / settings.time_step_s)));
  for (bool still = false; !still;) {
    const Eigen::Matrix3Xd before_m = simulation.state().positions_m;
    for (int i = 0; i < steps; ++i) {
      const SolveReport report = simulation.step();
      if (!report.converged) judged.failed = "in time: " + report.message;
    }
    still = largest_way_m(simulation, before_m) < settings.still_m;
    if (!still && simulation.state().time_s > settings.longest_s) return false;
  }
  return true;
}

void note_warnings(const SolveReport& report, JudgedScene& judged) {
  for (const SolveWarning& warning : report.warnings) {
    judged.said += (judged.said.empty() ? "" : ", ") + warning.kind;
    judged.open = judged.open || warning.kind == "coarse_contact" ||
                  (warning.kind == "snapped" && warning.text.find("the other side") != std::string::npos);
  }
}

// How far the nodes end from the equilibrium, in time.
void let_time_judge(const DrawnScene& scene, const DrawnSettings& settings, const ExperimentContext& context,
                    const Eigen::Matrix3Xd& rest_m, JudgedScene& judged) {
  const std::unique_ptr<Simulation> slow = bring_slowly(scene, settings, context, judged);
  const bool still = let_settle(settings, *slow, judged);
  judged.apart_m = largest_way_m(*slow, rest_m);
  // Contact that trembles by less than what is asked for is no matter.
  if (!still && judged.apart_m > settings.within_m) judged.failed = "in time: not at rest yet";
  judged.moved_m = largest_way_m(*slow, slow->body().mesh().nodes_m);
  judged.rest_after_s = slow->state().time_s;
}

}  // namespace

DrawnSettings read_drawn_settings(const YamlNode& node) {
  DrawnSettings settings;
  settings.first_seed = static_cast<std::uint64_t>(node.integer("first_seed", 0, 1000000000));
  settings.scenes = node.integer("scenes", 0, 100000);
  settings.joined_scenes = node.integer("joined_scenes", 0, 100000);
  settings.motion_s = node.number("motion_s", AllowedRange::positive());
  settings.time_step_s = node.number("time_step_s", AllowedRange::positive());
  settings.rayleigh_mass_per_s = node.number("rayleigh_mass_per_s", AllowedRange::not_negative());
  settings.within_m = node.number("within_m", AllowedRange::positive());
  settings.still_m = node.number("still_m", AllowedRange::positive());
  settings.still_for_s = node.number("still_for_s", AllowedRange::positive());
  settings.longest_s = node.number("longest_s", AllowedRange::positive());
  return settings;
}

JudgedScene judge_drawn_scene(const DrawnScene& scene, const DrawnSettings& settings,
                              const ExperimentContext& context) {
  const double start_s = cpu_time_s();
  JudgedScene judged;
  judged.name = scene.name;
  const std::unique_ptr<Simulation> at_rest = load(scene, 1.0, {}, context);
  give_commands(scene, 1.0, *at_rest);
  const SolveReport report = at_rest->solve_equilibrium();
  note_warnings(report, judged);
  if (!report.converged) judged.failed = "equilibrium: " + report.message;
  const Eigen::Matrix3Xd& rest_m = at_rest->state().positions_m;
  JudgedScene first = judged;
  let_time_judge(scene, settings, context, rest_m, first);
  if (first.right(settings.within_m) || !judged.failed.empty()) {
    judged = std::move(first);
  } else {
    DrawnSettings finer = settings;
    finer.time_step_s /= kFiner;
    let_time_judge(scene, finer, context, rest_m, judged);
  }
  judged.cpu_s = cpu_time_s() - start_s;
  return judged;
}

}  // namespace soft_robot_lab
