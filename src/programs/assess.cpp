// SPDX-License-Identifier: BSD-3-Clause
// assess ROBOT.yaml: how far a design reaches, and what that takes.
#include <iostream>
#include <string>
#include <vector>

#include "load_with_bar.h"
#include "robot/scene/parameters.h"
#include "settings/command_line.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/robot/scene/scene.h"
#include "study/search/assessment.h"

namespace {

using namespace soft_robot_lab;

struct Arguments {
  std::string robot, result;
  std::vector<std::string> set;
  AssessmentSettings settings;
};

void declare(CommandLine& app, Arguments& arguments) {
  AssessmentSettings& settings = arguments.settings;
  app.add_option("ROBOT", arguments.robot, "a robot's file").type_name("FILE").required();
  app.add_option("--marker", settings.marker, "whose reach counts: tip, else the last").type_name("NAME");
  app.add_option("--steps", settings.steps, "of each command, from rest to its end")
      .type_name("N")
      .range(2, 100)
      .show_default();
  app.add_flag("--one-at-a-time", settings.one_at_a_time, "change one command, while the others rest");
  app.add_option("--max-tension", settings.max_tension_n, "rest states beyond do not count").type_name("N");
  app.add_option_function<std::vector<double>>(
         "--target",
         [&settings](const std::vector<double>& at_m) { settings.targets_m.emplace_back(at_m[0], at_m[1], at_m[2]); },
         "a place that policies should bring the marker to [m, robot_base]; can be repeated")
      .type_name("X Y Z")
      .expected(3)
      .in_order();
  app.add_set_option(arguments.set);
  app.add_option("--result", arguments.result, "where the answer goes as JSON").type_name("FILE");
  app.footer("Exit status: 0 assessed, 1 it does not rest, 2 bad robot or arguments.");
}

int assess_robot(const Arguments& arguments) {
  SceneOptions options;
  options.actuator_factory = make_actuator;
  options.overrides = parameter_overrides(arguments.robot, arguments.set);
  const Scene scene = load_scene(arguments.robot, options);
  print_warnings("assess", scene);
  const nlohmann::ordered_json result = assess(arguments.robot, *scene.simulation, arguments.settings);
  for (const auto& [name, value] : result.items()) std::cout << name << " " << value.dump() << "\n";
  if (!arguments.result.empty()) write_file(arguments.result, result.dump(2) + "\n");
  return kGood;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app("Measures how far a robot reaches over its commands, and what that takes, without a ROS master.",
                  "assess");
  Arguments arguments;
  declare(app, arguments);
  return run_program(app, argc, argv, [&] { return assess_robot(arguments); });
}
