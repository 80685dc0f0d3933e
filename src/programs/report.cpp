// SPDX-License-Identifier: BSD-3-Clause
// report BAG --output FOLDER: a recorded session as one HTML page.
#include <cstdio>
#include <stdexcept>
#include <string>

#include "settings/command_line.h"
#include "ros/report/session_report.h"

namespace {

using namespace soft_robot_lab;

struct Arguments {
  std::string bag, output, scene;
  bool configurations = false;
};

void declare(CommandLine& app, Arguments& arguments) {
  app.add_option("BAG", arguments.bag, "a recorded session").type_name("FILE").required();
  app.add_option("--output", arguments.output, "a folder for report.html and its pictures (PNG, SVG, CSV)")
      .type_name("FOLDER")
      .required();
  app.add_option("--scene", arguments.scene, "the robot's file, where it is not the one that the recording names")
      .type_name("FILE");
  app.add_flag("--configurations", arguments.configurations, "a page for each configuration at rest, too");
  app.footer("Exit status: 0 written, 2 bad recording or arguments.");
}

int report(const Arguments& arguments) {
  const SessionReport written =
      write_session_report(arguments.bag, arguments.output, arguments.scene, arguments.configurations);
  std::printf("%s: %d configurations at rest", written.page.c_str(), written.rest_periods);
  if (written.rest_periods > 0) std::printf(", rms gap %.3f mm", 1e3 * written.rest_rms_m);
  std::printf("\n");
  return kGood;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app(
      "Writes a recorded session as one HTML page that holds its pictures: gap over time and by configuration, "
      "policy,\n"
      "trajectories, what the cameras saw, the scene and the versions.",
      "report");
  Arguments arguments;
  declare(app, arguments);
  return run_program(app, argc, argv, [&] { return report(arguments); });
}
