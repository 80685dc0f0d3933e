// SPDX-License-Identifier: BSD-3-Clause
// simulate SCENE.yaml [--result FILE] [--estimate-error]: runs a scene from the shell, without a ROS master.
#include <iostream>
#include <stdexcept>
#include <string>

#include "settings/command_line.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/robot/scene/run_scene.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace {

using namespace soft_robot_lab;

constexpr const char* kUsage =
    "usage: simulate SCENE.yaml [--result FILE] [--estimate-error]\n"
    "Runs the scene and writes the result as JSON to FILE, or to the standard output.\n"
    "--estimate-error  also reports how wrong the scene's mesh and time step make the markers.\n"
    "Exit status: 0 converged, 1 ran but did not converge or did not meet the scene's fidelity (the result is still\n"
    "written), 2 bad scene or arguments.\n";

struct Arguments {
  std::string scene;
  std::string result;  // empty: standard output
  bool estimate_error = false;
  bool help = false;
};

Arguments parse(int count, char** values) {
  Arguments arguments;
  for (int i = 1; i < count; ++i) {
    const std::string word = values[i];
    if (word == "-h" || word == "--help") {
      arguments.help = true;
    } else if (word == "--estimate-error") {
      arguments.estimate_error = true;
    } else if (word == "--result") {
      if (++i == count) throw std::invalid_argument("--result needs a file name");
      arguments.result = values[i];
    } else if (!word.empty() && word[0] == '-') {
      throw std::invalid_argument("unknown option " + word);
    } else if (arguments.scene.empty()) {
      arguments.scene = word;
    } else {
      throw std::invalid_argument("more than one scene: " + word);
    }
  }
  if (arguments.scene.empty() && !arguments.help) throw std::invalid_argument("no scene given");
  return arguments;
}

int simulate(const Arguments& arguments) {
  SceneOptions options;
  options.actuator_factory = make_actuator;
  options.estimate_error = arguments.estimate_error;
  Scene scene = load_scene(arguments.scene, options);
  const RunReport report = run_scene(scene);
  for (const SolveWarning& warning : report.solve.warnings) std::cerr << "simulate: warning: " << warning.text << "\n";
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

int main(int argc, char** argv) { return run_program("simulate", kUsage, argc, argv, parse, simulate); }
