// SPDX-License-Identifier: BSD-3-Clause
// check_casting ROBOT.yaml [--surface-alone] [--result FILE] [--page FOLDER]: whether a robot can be cast in silicone,
// and why not.
#include <iostream>
#include <string>
#include <vector>

#include "robot/casting/cast_robot.h"
#include "robot/casting/check_casting.h"
#include "robot/casting/mould_plan.h"
#include "robot/casting/verdict_page.h"
#include "robot/scene/parameters.h"
#include "settings/command_line.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"

namespace {

using namespace soft_robot_lab;

struct Arguments {
  std::string robot, result, page;
  std::vector<std::string> set;
  bool surface_alone = false;
};

void declare(CommandLine& app, Arguments& arguments) {
  app.add_option("ROBOT", arguments.robot, "the robot's file, whose block casting has the limits")
      .type_name("FILE")
      .required();
  app.add_set_option(arguments.set);
  app.add_flag("--surface-alone", arguments.surface_alone,
               "make no mesh for simulations: for large surfaces; leaves mesh_quality out");
  app.add_option("--result", arguments.result, "where the verdict goes as JSON").type_name("FILE");
  app.add_option("--page", arguments.page, "where a page with pictures of the verdict goes").type_name("FOLDER");
  app.footer("Exit status: 0 castable, also in what casting.allow names, 1 not, 2 bad file or arguments.");
}

void print(const CastingVerdict& verdict) {
  std::cout << (verdict.castable ? "castable" : "not castable") << ", out of its mould along ["
            << verdict.direction.transpose() << "]\n";
  for (const CastingTest& test : verdict.tests) {
    const std::string by = test.by.empty() ? "" : " by " + test.by, margin = margin_text(test);
    std::cout << (test.passed ? "  passed  " : "  failed  ") << test.name << by << (margin.empty() ? "" : ": ")
              << margin << "\n";
    if (!test.passed) std::cout << "          " << test.why << "\n";
  }
  if (!verdict.note.empty()) std::cout << "  note    " << verdict.note << "\n";
}

int check(const Arguments& arguments) {
  SceneOptions options;
  options.actuator_factory = make_actuator;
  options.overrides = parameter_overrides(arguments.robot, arguments.set);
  const auto load = arguments.surface_alone ? load_cast_surface : load_cast_robot_in_use;
  const CastRobotFile file = load(arguments.robot, options);
  CastingVerdict verdict = with_allowed_moulds(file, check_casting(file));
  verdict.note = note_on_fibres(file.fibres);
  if (!arguments.result.empty()) write_file(arguments.result, verdict_json(verdict));
  if (!arguments.page.empty())
    write_verdict(verdict, robot_name(arguments.robot), file.settings.min_thickness_m, arguments.page);
  print(verdict);
  return verdict.castable ? kGood : kNotGood;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app("Checks whether a robot can be cast in silicone, and why not.", "check_casting");
  Arguments arguments;
  declare(app, arguments);
  return run_program(app, argc, argv, [&] { return check(arguments); });
}
