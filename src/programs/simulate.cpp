// SPDX-License-Identifier: BSD-3-Clause
// simulate SCENE.yaml [--result FILE] [--set PATH=NUMBER] [--estimate-error]: runs a scene from the shell, without a
// ROS master.
#include <chrono>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "load_with_bar.h"
#include "robot/scene/parameters.h"
#include "robot/scene/solve_watch.h"
#include "settings/command_line.h"
#include "settings/interrupted.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/robot/scene/run_scene.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace {

using namespace soft_robot_lab;

struct Arguments {
  std::string scene;
  std::string result;  // empty: standard output
  bool estimate_error = false;
  std::vector<std::string> set;
};

void declare(CommandLine& app, Arguments& arguments) {
  app.add_option("SCENE", arguments.scene, "a scene's or robot's file").type_name("FILE").required();
  app.add_option("--result", arguments.result, "where the result goes as JSON; otherwise to the standard output")
      .type_name("FILE");
  app.add_set_option(arguments.set);
  app.add_flag("--estimate-error", arguments.estimate_error,
               "also report how wrong the scene's mesh and time step make the markers");
  app.footer(
      "Exit status: 0 converged, 1 ran but did not converge, was ended by Ctrl-C, or did not meet the scene's "
      "fidelity\n"
      "(the result is still written), 2 bad scene or arguments.");
}

double now_s() {
  using Clock = std::chrono::steady_clock;
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

// With a bar where it lasts longer than a second, and a line within each solve that does. Ctrl-C or SIGTERM ends it,
// also within a solve, and what was simulated until then is written.
RunReport run(Scene& scene) {
  heed_interrupts();
  std::optional<ProgressBar> bar;
  SolveWatch watch(*scene.simulation);
  double done = 0.0;
  const auto show = [&](const std::string& what) {
    if (!bar) bar.emplace("simulate");
    bar->show(done, what);
  };
  scene.simulation->set_interrupt([&] {
    if (const std::optional<std::string> said = watch.say(now_s())) show(*said);
    return interrupted();
  });
  const double start_s = now_s();
  watch.begin(start_s);
  const RunReport report = run_scene(scene, [&](double fraction) {
    done = fraction;
    watch.begin(now_s());
    if (bar || (fraction < 1.0 && now_s() - start_s > 1.0)) show("runs; Ctrl-C ends it and keeps what is done");
    return !interrupted();
  });
  scene.simulation->set_interrupt(interrupted);
  return report;
}

int simulate(const Arguments& arguments) {
  SceneOptions options;
  options.actuator_factory = make_actuator;
  options.overrides = parameter_overrides(arguments.scene, arguments.set);
  options.estimate_error = arguments.estimate_error;
  Scene scene = load_with_bar("simulate", arguments.scene, options);
  const RunReport report = run(scene);
  print_new_warnings("simulate", scene, report.solve.warnings);
  if (arguments.result.empty()) {
    std::cout << result_json(scene, report) << std::flush;
  } else {
    write_file(arguments.result, result_json(scene, report));
    std::cout << result_summary(scene, report);
  }
  if (!report.solve.converged) std::cerr << "simulate: did not converge: " << report.solve.message << "\n";
  const bool met = !scene.fidelity || scene.fidelity->met;
  if (!met) std::cerr << "simulate: expected error of the markers: " << expected_error_text(*scene.fidelity) << "\n";
  return report.solve.converged && met ? kGood : kNotGood;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app("Runs a scene and writes its result, without a ROS master.", "simulate");
  Arguments arguments;
  declare(app, arguments);
  return run_program(app, argc, argv, [&] { return simulate(arguments); });
}
