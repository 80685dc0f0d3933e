// SPDX-License-Identifier: BSD-3-Clause
// check_casting ROBOT.yaml [--result FILE]: whether a robot can be cast in silicone, and why not.
#include <iostream>
#include <string>
#include <vector>

#include "robot/casting/cast_robot.h"
#include "robot/casting/check_casting.h"
#include "robot/scene/parameters.h"
#include "settings/command_line.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"

namespace {

using namespace soft_robot_lab;

struct Arguments {
  std::string robot, result;
  std::vector<std::string> set;
};

void declare(CLI::App& app, Arguments& arguments) {
  app.add_option("ROBOT", arguments.robot, "the robot's file, whose block casting has the limits")
      ->type_name("FILE")
      ->required();
  add_set_option(app, arguments.set);
  app.add_option("--result", arguments.result, "where the verdict goes as JSON")->type_name("FILE");
  app.footer("Exit status: 0 castable, 1 not, 2 bad file or arguments.");
}

void print(const CastingVerdict& verdict) {
  std::cout << (verdict.castable ? "castable" : "not castable") << ", out of its mould along ["
            << verdict.direction.transpose() << "]\n";
  for (const CastingTest& test : verdict.tests)
    std::cout << (test.passed ? "  passed  " : "  failed  ") << test.name << (test.why.empty() ? "" : ": ") << test.why
              << "\n";
}

int check(const Arguments& arguments) {
  SceneOptions options;
  options.actuator_factory = make_actuator;
  options.overrides = parameter_overrides(arguments.robot, arguments.set);
  const CastRobotFile file = load_cast_robot(arguments.robot, options);
  const CastingVerdict verdict = check_casting(file);
  if (!arguments.result.empty()) write_file(arguments.result, verdict_json(verdict));
  print(verdict);
  return verdict.castable ? kGood : kNotGood;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Checks whether a robot can be cast in silicone, and why not.", "check_casting");
  Arguments arguments;
  declare(app, arguments);
  return run_program(app, argc, argv, [&] { return check(arguments); });
}
