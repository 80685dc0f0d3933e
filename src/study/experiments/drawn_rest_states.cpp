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
  const YamlNode drawn = YamlNode::parse(scene.text(share_of_loads), "drawn scene");
  if (scene.robot.empty()) return load_scene(drawn, context.scene_options(overrides)).simulation;
  const Overrides all = Overrides(drawn).lay(overrides);
  return load_scene(context.config_folder + "/" + scene.robot, context.scene_options(all)).simulation;
}

void give_commands(const DrawnScene& scene, double share, Simulation& simulation) {
  for (const auto& [name, value] : scene.commands) {
    const double rest =
        simulation.actuators()[static_cast<std::size_t>(simulation.actuator_index(name))]->limits().rest;
    simulation.set_command(name, rest + share * (value - rest));
  }
}

double largest_way_m(const Simulation& simulation, const Eigen::Matrix3Xd& from_m) {
  return (simulation.state().positions_m - from_m).colwise().norm().maxCoeff();
}

// Where a slow, damped motion in time ends.
struct SlowEnd {
  std::unique_ptr<Simulation> simulation;
  bool still = false;
  std::string failed;
};

// Steps in which the loads grow with all else; each is made by a simulation of its own.
void bring_slowly(const DrawnScene& scene, const DrawnSettings& settings, const ExperimentContext& context,
                  SlowEnd& end) {
  const Overrides damped = Overrides()
                               .set({"body", "damping", "rayleigh_mass_per_s"}, settings.rayleigh_mass_per_s)
                               .set({"solver", "integrator"}, "implicit_euler")
                               .set({"solver", "time_step_s"}, settings.time_step_s);
  const int steps = std::max(1, static_cast<int>(std::lround(settings.motion_s / settings.time_step_s)));
  for (int i = 1; i <= steps; ++i) {
    const double share = static_cast<double>(i) / steps;
    std::unique_ptr<Simulation> next = load(scene, share, damped, context);
    if (end.simulation) next->set_state(end.simulation->state());
    end.simulation = std::move(next);
    give_commands(scene, share, *end.simulation);
    const SolveReport report = end.simulation->step();
    if (!report.converged) end.failed = "in time: " + report.message;
  }
}

SlowEnd go_slowly(const DrawnScene& scene, const DrawnSettings& settings, const ExperimentContext& context) {
  SlowEnd end;
  bring_slowly(scene, settings, context, end);
  Simulation& simulation = *end.simulation;
  const int steps = std::max(1, static_cast<int>(std::lround(settings.still_for_s / settings.time_step_s)));
  while (!end.still && simulation.state().time_s <= settings.longest_s) {
    const Eigen::Matrix3Xd before_m = simulation.state().positions_m;
    for (int i = 0; i < steps; ++i) {
      const SolveReport report = simulation.step();
      if (!report.converged) end.failed = "in time: " + report.message;
    }
    end.still = largest_way_m(simulation, before_m) < settings.still_m;
  }
  return end;
}

void note_warnings(const SolveReport& report, JudgedScene& judged) {
  for (const SolveWarning& warning : report.warnings) {
    judged.said += (judged.said.empty() ? "" : ", ") + warning.kind;
    judged.open = judged.open || warning.kind == "coarse_contact" ||
                  (warning.kind == "snapped" && warning.text.find("the other side") != std::string::npos);
  }
}

struct Rest {
  JudgedScene judged;  // so far
  Eigen::Matrix3Xd positions_m;
};

Rest find_rest(const DrawnScene& scene, const std::string& method, const ExperimentContext& context) {
  Rest rest;
  rest.judged.name = scene.name;
  rest.judged.method = method;
  const double start_s = cpu_time_s();
  const auto simulation = load(scene, 1.0, Overrides().set({"solver", "method"}, method), context);
  give_commands(scene, 1.0, *simulation);
  const SolveReport report = simulation->solve_equilibrium();
  note_warnings(report, rest.judged);
  if (!report.converged) rest.judged.failed = "equilibrium: " + report.message;
  rest.positions_m = simulation->state().positions_m;
  rest.judged.cpu_s = cpu_time_s() - start_s;
  return rest;
}

// How far the nodes end from the equilibrium, in time.
JudgedScene compare(const Rest& rest, const SlowEnd& slow, const DrawnSettings& settings) {
  JudgedScene judged = rest.judged;
  judged.apart_m = largest_way_m(*slow.simulation, rest.positions_m);
  if (judged.failed.empty()) judged.failed = slow.failed;
  // Contact that trembles by less than what is asked for is no matter.
  if (!slow.still && judged.apart_m > settings.within_m) judged.failed = "in time: not at rest yet";
  judged.moved_m = largest_way_m(*slow.simulation, slow.simulation->body().mesh().nodes_m);
  judged.motion_s = settings.motion_s;
  judged.rest_after_s = slow.simulation->state().time_s;
  return judged;
}

std::vector<DrawnSettings> slower_ways(const DrawnSettings& settings) {
  DrawnSettings way = settings;
  way.time_step_s /= kFiner;
  std::vector<DrawnSettings> ways{way};
  for (const double motion_s : settings.slower_motions_s) {
    way.motion_s = motion_s;
    ways.push_back(way);
  }
  return ways;
}

}  // namespace

DrawnSettings read_drawn_settings(const YamlNode& node) {
  DrawnSettings settings;
  settings.first_seed = static_cast<std::uint64_t>(node.integer("first_seed", 0, 1000000000));
  settings.scenes = node.integer("scenes", 0, 100000);
  settings.joined_scenes = node.integer("joined_scenes", 0, 100000);
  settings.robot_scenes = node.integer("robot_scenes", 0, 100000);
  for (const YamlNode& robot : node.sequence("robots")) settings.robots.push_back(robot.as_text());
  for (const YamlNode& method : node.sequence("methods")) settings.methods.push_back(method.as_text());
  settings.motion_s = node.number("motion_s", AllowedRange::positive());
  for (const YamlNode& slower : node.sequence("slower_motions_s"))
    settings.slower_motions_s.push_back(slower.as_number(AllowedRange::positive()));
  settings.time_step_s = node.number("time_step_s", AllowedRange::positive());
  settings.rayleigh_mass_per_s = node.number("rayleigh_mass_per_s", AllowedRange::not_negative());
  settings.within_m = node.number("within_m", AllowedRange::positive());
  settings.still_m = node.number("still_m", AllowedRange::positive());
  settings.still_for_s = node.number("still_for_s", AllowedRange::positive());
  settings.longest_s = node.number("longest_s", AllowedRange::positive());
  return settings;
}

std::vector<JudgedScene> judge_drawn_scene(const DrawnMotion& draw, const DrawnSettings& settings,
                                           const ExperimentContext& context) {
  const DrawnScene first = draw(settings.motion_s);
  std::vector<Rest> rests;
  for (const std::string& method : settings.methods) rests.push_back(find_rest(first, method, context));
  std::vector<JudgedScene> all;
  const SlowEnd slow = go_slowly(first, settings, context);
  for (const Rest& rest : rests) all.push_back(compare(rest, slow, settings));
  const auto doubtful = [&](std::size_t i) {
    return rests[i].judged.failed.empty() && !all[i].right(settings.within_m);
  };
  for (const DrawnSettings& slower : slower_ways(settings)) {
    std::vector<std::size_t> doubts;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (doubtful(i)) doubts.push_back(i);
    if (doubts.empty()) break;
    const SlowEnd end = go_slowly(draw(slower.motion_s), slower, context);
    for (const std::size_t i : doubts) all[i] = compare(rests[i], end, slower);
  }
  return all;
}

}  // namespace soft_robot_lab
