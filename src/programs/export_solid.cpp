// SPDX-License-Identifier: BSD-3-Clause
// export_solid ROBOT.yaml --output FILE: the body's solid as STL, 3MF or STEP, in millimetres.
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "robot/casting/cast_robot.h"
#include "robot/casting/stl_file.h"
#include "robot/casting/three_mf.h"
#include "robot/design/surface_file.h"
#include "robot/scene/parameters.h"
#include "robot/scene/sections.h"
#include "settings/command_line.h"
#include "settings/limits.h"
#include "settings/read_file.h"
#include "soft_robot_lab/robot/design/solid.h"

namespace {

using namespace soft_robot_lab;

constexpr std::uintmax_t kLargestFile_bytes = limits::kStep_bytes;

struct Arguments {
  std::string robot, output;
  double largest_edge_m = 0.005;
  std::vector<std::string> set;
};

void declare(CommandLine& app, Arguments& arguments) {
  app.add_option("ROBOT", arguments.robot, "the robot's file, whose body.solid goes out").type_name("FILE").required();
  app.add_option("--output", arguments.output, "ends with .stl, .3mf or .step; in millimetres")
      .type_name("FILE")
      .required();
  app.add_option("--largest-edge", arguments.largest_edge_m, "of the triangles in an STL or 3MF file, in metres")
      .range(1e-5, 1.0)
      .show_default();
  app.add_set_option(arguments.set);
  app.footer("Exit status: 0 written, 2 bad file or arguments.");
}

Surface surface_of(const Solid& solid, double largest_edge_m) {
  SurfaceRequest request;
  request.solid = solid;
  request.largest_edge_m = largest_edge_m;
  return read_off(surface_file_for(request, {}));
}

std::string content_of(const Solid& solid, const std::string& ending, const Arguments& arguments) {
  if (ending == ".step") return read_regular_file(step_file_for(solid, {}), kLargestFile_bytes);
  const Surface surface = surface_of(solid, arguments.largest_edge_m);
  return ending == ".3mf" ? three_mf(surface, robot_name(arguments.robot))
                          : binary_stl(surface, "soft_robot_lab solid, millimetres");
}

int write(const Arguments& arguments) {
  const std::string ending = std::filesystem::path(arguments.output).extension();
  if (ending != ".stl" && ending != ".3mf" && ending != ".step")
    throw std::invalid_argument("--output: '" + arguments.output + "' must end with .stl, .3mf or .step");
  const YamlNode robot =
      with_overrides(load_settings(arguments.robot), parameter_overrides(arguments.robot, arguments.set));
  const Solid solid = read_body_solid(robot.child("body"));
  write_file(arguments.output, content_of(solid, ending, arguments));
  return kGood;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app("Writes the solid of a robot's body as STL, 3MF or STEP.", "export_solid");
  Arguments arguments;
  declare(app, arguments);
  return run_program(app, argc, argv, [&] { return write(arguments); });
}
