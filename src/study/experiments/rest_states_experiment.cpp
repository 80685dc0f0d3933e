// SPDX-License-Identifier: BSD-3-Clause
#include "rest_states_experiment.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <sstream>
#include <utility>

#include "control/identification/simulated_now.h"
#include "drawn_rest_states.h"
#include "drawn_robots.h"
#include "judged_scenes.h"
#include "soft_robot_lab/robot/scene/scene.h"
#include "settings/cpu_time.h"
#include "settings/read_file.h"
#include "settings/words.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

struct RestBody {
  std::string name, scene;
  Overrides overrides;
  std::vector<std::pair<std::string, double>> commands;
};

struct RestMethod {
  std::string name;
  Overrides solver;
  std::vector<double> steps_s;
  std::vector<double> substeps;  // one for each step, or none
};

struct RestSettings {
  double rayleigh_mass_per_s, start_share, still_m, still_for_s, longest_s;
  std::vector<RestBody> bodies;
  std::vector<RestMethod> methods;
  DrawnSettings drawn;
};

std::vector<double> optional_numbers(const YamlNode& node, const std::string& key) {
  std::vector<double> values;
  for (const YamlNode& item : node.optional_sequence(key)) values.push_back(item.as_number(AllowedRange::positive()));
  return values;
}

RestSettings read_rest_settings(const ExperimentContext& context) {
  const YamlNode node = YamlNode::load_file(context.settings_file("rest_states"));
  RestSettings settings;
  settings.rayleigh_mass_per_s = node.number("rayleigh_mass_per_s", AllowedRange::not_negative());
  settings.start_share = node.number("start_share", {0.0, 1.0});
  settings.still_m = node.number("still_m", AllowedRange::positive());
  settings.still_for_s = node.number("still_for_s", AllowedRange::positive());
  settings.longest_s = node.number("longest_s", AllowedRange::positive());
  for (const YamlNode& item : node.sequence("bodies")) {
    RestBody body{item.text("name"), context.config_folder + "/" + item.text("scene"), {}, {}};
    if (const auto overrides = item.optional_child("overrides")) body.overrides = Overrides(*overrides);
    const YamlNode commands = item.child("commands");
    for (const std::string& name : commands.keys())
      body.commands.emplace_back(name, commands.number(name, AllowedRange::positive()));
    settings.bodies.push_back(body);
  }
  for (const YamlNode& item : node.sequence("methods")) {
    RestMethod method{item.text("name"), Overrides(item.child("solver")), optional_numbers(item, "steps_s"),
                      optional_numbers(item, "substeps")};
    if (method.steps_s.empty()) item.fail("steps_s is empty");
    if (!method.substeps.empty() && method.substeps.size() != method.steps_s.size())
      item.fail("substeps must name one for each of steps_s");
    settings.methods.push_back(method);
  }
  settings.drawn = read_drawn_settings(node.child("drawn"));
  node.require_all_read();
  return settings;
}

double largest_distance(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return (a - b).colwise().norm().maxCoeff();
}

Scene load(const ExperimentContext& context, const RestSettings& settings, const RestBody& body,
           const Overrides& solver) {
  Overrides overrides = body.overrides;
  overrides.set({"body", "damping", "rayleigh_mass_per_s"}, settings.rayleigh_mass_per_s);
  overrides.lay(Overrides().set({"solver"}, solver));
  return load_scene(body.scene, context.scene_options(overrides));
}

// This share of the way from the actuators' rest to the commands.
void give_commands(const RestBody& body, double fraction, Simulation& simulation) {
  for (const auto& [name, value] : body.commands) {
    const double rest =
        simulation.actuators()[static_cast<std::size_t>(simulation.actuator_index(name))]->limits().rest;
    simulation.set_command(name, rest + fraction * (value - rest));
  }
}

SimulationState equilibrium(const RestBody& body, double fraction, Simulation& simulation) {
  give_commands(body, fraction, simulation);
  const SolveReport report = simulation.solve_equilibrium();
  if (!report.converged) throw std::runtime_error(body.name + ": " + report.message);
  return simulation.state();
}

// A body with commands begins at rest near its end; one without, in its rest shape.
void start(const RestBody& body, const SimulationState& near, Simulation& simulation) {
  if (body.commands.empty()) return;
  SimulationState state = simulation.state();
  state.positions_m = near.positions_m;
  state.element_multipliers_pa = near.element_multipliers_pa;
  state.constraint_multipliers = near.constraint_multipliers;
  state.take_commands(near);
  state.element_forces_n.resize(0);
  simulation.set_state(state);
  give_commands(body, 1.0, simulation);
}

struct Settled {
  Eigen::Matrix3Xd markers_m;
  bool still = false;
  double time_s = 0.0, cpu_s = 0.0;
  std::string message;
};

Settled settle(const RestSettings& settings, Simulation& simulation) {
  Settled settled;
  const double start_s = cpu_time_s(), h = simulation.options().time_step_s;
  const int steps = std::max(1, static_cast<int>(std::lround(settings.still_for_s / h)));
  settled.markers_m = places(simulation);
  while (!settled.still && simulation.state().time_s < settings.longest_s) {
    settled.message.clear();
    for (int i = 0; i < steps; ++i) {
      const SolveReport report = simulation.step();
      if (!report.converged) settled.message = report.message;
    }
    const Eigen::Matrix3Xd now_m = places(simulation);
    settled.still = settled.message.empty() && largest_distance(now_m, settled.markers_m) < settings.still_m;
    settled.markers_m = now_m;
  }
  settled.time_s = simulation.state().time_s;
  settled.cpu_s = cpu_time_s() - start_s;
  if (!settled.still && settled.message.empty()) settled.message = "not at rest yet";
  return settled;
}

Overrides solver_of(const RestMethod& method, std::size_t i) {
  Overrides solver = method.solver;
  solver.set({"time_step_s"}, method.steps_s[i]);
  if (!method.substeps.empty()) solver.set({"substeps"}, method.substeps[i]);
  return solver;
}

DrawnMotion drawn(int i, const DrawnSettings& settings, const ExperimentContext& context) {
  const int robots = settings.scenes + settings.joined_scenes;
  return [i, robots, &settings, &context](double motion_s) {
    const auto seed = [&](int first) { return settings.first_seed + static_cast<std::uint64_t>(i - first); };
    if (i < settings.scenes) return draw_scene(seed(0), motion_s);
    if (i < robots) return draw_joined_scene(seed(settings.scenes), motion_s);
    return draw_robot_scene(seed(robots), motion_s, settings.robots, context);
  };
}

// Rows of those whose equilibrium says something or is not where time leads.
void judge_drawn_scenes(const DrawnSettings& settings, const ExperimentContext& context, ExperimentResult& result) {
  JudgedScenes all(context.output_folder + "/judged.jsonl",
                   read_regular_file(context.settings_file("rest_states"), kLargestSettings_bytes));
  int judgements = 0, right = 0, said = 0;
  double worst_m = 0.0;
  const int scenes = settings.scenes + settings.joined_scenes + settings.robot_scenes;
  for (int i = 0; i < scenes; ++i) {
    const DrawnMotion scene = drawn(i, settings, context);
    context.report(0.5 + 0.5 * i / scenes, scene(settings.motion_s).name);
    if (!all.find(i)) all.add(i, judge_drawn_scene(scene, settings, context));
    for (const JudgedScene& judged : *all.find(i)) {
      const bool apart = judged.apart_m > settings.within_m;
      ++judgements;
      if (judged.right(settings.within_m)) {
        ++right;
        said += apart ? 1 : 0;
        if (!apart) worst_m = std::max(worst_m, judged.apart_m);
      } else {
        result.converged = false;
        result.message +=
            judged.name + ", " + judged.method + ": " + (judged.failed.empty() ? "apart" : judged.failed) + "; ";
      }
      if (apart || !judged.failed.empty() || !judged.said.empty())
        result.table.rows.push_back(
            {judged.name, judged.method + ", slowly, in " + format_number(judged.motion_s) + " s",
             1e3 * settings.time_step_s, judged.rest_after_s, judged.cpu_s, 1e3 * judged.moved_m, 1e6 * judged.apart_m,
             judged.failed.empty() ? judged.said : judged.failed});
    }
  }
  result.numbers["drawn_scenes"] = judgements;
  result.numbers["drawn_right"] = right;
  std::ostringstream words;
  words.precision(2);
  words << " Of " << judgements << " equilibria of " << scenes << " drawn scenes " << right
        << " rest where a slow motion in time leads, within " << 1e6 * worst_m << " um, or say why not (" << said
        << ").";
  if (all.of_earlier_run() > 0) words << ' ' << all.of_earlier_run() << " of the scenes were judged by an earlier run.";
  result.we_find += words.str();
}

}  // namespace

ExperimentResult run_rest_states_experiment(const ExperimentContext& context) {
  const RestSettings settings = read_rest_settings(context);
  ExperimentResult result;
  result.title = "Rest states reached in time, and the equilibrium";
  result.table.columns = {{"body"},
                          {"method"},
                          {"time step [ms]", 3},
                          {"at rest after [s]", 3},
                          {"CPU time [s]", 3},
                          {"moved by [mm]"},
                          {"from equilibrium [um]", 2},
                          {"remark"}};
  double worst_m = 0.0, done = 0.0;
  for (const RestBody& body : settings.bodies) {
    const Scene still = load(context, settings, body, {});
    const Eigen::Matrix3Xd start_m = places(*still.simulation);
    const SimulationState near = equilibrium(body, settings.start_share, *still.simulation);
    equilibrium(body, 1.0, *still.simulation);
    const Eigen::Matrix3Xd rest_m = places(*still.simulation);
    for (const RestMethod& method : settings.methods) {
      context.report(done++ / static_cast<double>(settings.bodies.size() * settings.methods.size()),
                     body.name + ", " + method.name);
      for (std::size_t i = 0; i < method.steps_s.size(); ++i) {
        const Scene scene = load(context, settings, body, solver_of(method, i));
        start(body, near, *scene.simulation);
        const Settled settled = settle(settings, *scene.simulation);
        const double off_m = largest_distance(settled.markers_m, rest_m);
        worst_m = std::max(worst_m, off_m);
        result.table.rows.push_back({body.name, method.name, 1e3 * method.steps_s[i], settled.time_s, settled.cpu_s,
                                     1e3 * largest_distance(settled.markers_m, start_m), 1e6 * off_m, settled.message});
        if (settled.still) continue;
        result.converged = false;
        result.message += body.name + ", " + method.name + ": " + settled.message + "; ";
      }
    }
  }
  result.numbers["worst_distance_m"] = worst_m;
  std::ostringstream words;
  words.precision(2);
  words << "at rest, no marker is further than " << 1e6 * worst_m
        << " um from the equilibrium, by any solver and with any time step.";
  result.we_find = words.str();
  judge_drawn_scenes(settings.drawn, context, result);
  return result;
}

}  // namespace soft_robot_lab
