// SPDX-License-Identifier: BSD-3-Clause
#include <sstream>

#include "sections.h"
#include "mechanics/simulation/limit_hint.h"
#include "mechanics/simulation/modal.h"
#include "settings/limits.h"

namespace soft_robot_lab {
namespace {

double read_command(const YamlNode& node, const Simulation& simulation, const Actuator& actuator) {
  const CommandLimits& limits = actuator.limits();
  const AllowedRange range{limits.min, limits.max};
  const double value = node.number(actuator.name());
  if (range.contains(value)) return value;
  const YamlNode command = node.child(actuator.name());
  command.fail(command.as_text() + " is out of range " + range.to_string() +
               limit_hint(simulation, simulation.actuator_index(actuator.name()), value < range.min));
}

// `time_s`, and any actuator by its name.
TimedCommands read_commands(const YamlNode& node, const Simulation& simulation) {
  TimedCommands timed;
  timed.time_s = node.number_or("time_s", timed.time_s, AllowedRange::not_negative());
  for (const auto& actuator : simulation.actuators()) {
    if (node.has(actuator->name()))
      timed.commands.emplace_back(actuator->name(), read_command(node, simulation, *actuator));
  }
  return timed;
}

// More would take weeks for the smallest body, and beyond 2^63 they cannot be counted.
void require_steps(const YamlNode& run, double duration_s, double time_step_s) {
  if (duration_s / time_step_s <= limits::kSteps) return;
  std::ostringstream text;
  text << duration_s << " is out of range (0, " << limits::kSteps * time_step_s << "]: " << duration_s / time_step_s
       << " steps of solver.time_step_s = " << time_step_s << ", at most " << limits::kSteps;
  run.child("duration_s").fail(text.str());
}

}  // namespace

RunSettings read_run(const YamlNode& scene, const Simulation& simulation) {
  RunSettings run;
  const std::optional<YamlNode> node = scene.optional_child("run");
  if (!node) return run;
  run.stated = true;
  const std::string mode = node->choice_or("mode", "equilibrium", {"equilibrium", "dynamic", "modal"});
  if (mode == "dynamic") {
    run.mode = RunMode::dynamic;
    run.duration_s = node->number("duration_s", AllowedRange::positive());
    require_steps(*node, run.duration_s, simulation.options().time_step_s);
    run.record_every_s = node->number_or("record_every_s", run.record_every_s, AllowedRange::not_negative());
  } else if (mode == "modal") {
    run.mode = RunMode::modal;
    run.modes = node->integer_or("modes", run.modes, 1, most_modes(simulation.body()));
    if (!node->optional_sequence("commands").empty()) {
      node->child("commands").fail("a modal run is about the rest shape; must be an empty list");
    }
  } else {
    run.sensitivity = node->boolean_or("sensitivity", run.sensitivity);
  }
  for (const YamlNode& item : node->optional_sequence("commands")) {
    run.commands.push_back(read_commands(item, simulation));
    const size_t count = run.commands.size();
    if (count > 1 && run.commands[count - 1].time_s < run.commands[count - 2].time_s) {
      item.child("time_s").fail("is earlier than the commands before it; must be in order of time");
    }
  }
  return run;
}

}  // namespace soft_robot_lab
