// SPDX-License-Identifier: BSD-3-Clause
// make_mould ROBOT.yaml --output FOLDER [--allow two_part,lid]: the mould that a robot is cast in, as STL and 3MF.
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "robot/casting/make_mould.h"
#include "robot/scene/parameters.h"
#include "settings/command_line.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"

namespace {

using namespace soft_robot_lab;

struct Arguments {
  std::string robot, output;
  std::vector<std::string> set, allow;
};

void declare(CommandLine& app, Arguments& arguments) {
  app.add_option("ROBOT", arguments.robot, "the robot's file, whose block casting has the mould's dimensions")
      .type_name("FILE")
      .required();
  app.add_option("--output", arguments.output, "where the mould goes; an earlier mould there is replaced")
      .type_name("FOLDER")
      .required();
  app.add_option("--allow", arguments.allow, "where one block does not do: two_part for two halves, lid for two pours")
      .type_name("WHAT")
      .delimiter(',')
      .one_of({"two_part", "lid"});
  app.add_set_option(arguments.set);
  app.footer("Exit status: 0 made, 1 no mould can be made or it could not be written, 2 bad file or arguments.");
}

void print(const Mould& mould, const std::string& folder) {
  for (const MouldPart& part : mould.parts)
    std::cout << part.name << ".stl: " << 1000 * part.size_m().transpose() << " mm, " << part.surface.triangle_count()
              << " triangles\n";
  std::cout << mould.silicone.part_a_g << " g of part A and " << mould.silicone.part_b_g
            << " g of part B; what to do is in " << folder << "/instructions.html\n";
}

Mould mould_of(const CastRobotFile& file, const std::string& path) {
  try {
    return make_mould(file);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(path + ": " + error.what());
  }
}

int make(const Arguments& arguments) {
  require_mould_folder(arguments.output);
  SceneOptions options;
  options.actuator_factory = make_actuator;
  options.overrides = parameter_overrides(arguments.robot, arguments.set);
  CastRobotFile file = load_cast_surface(arguments.robot, options);
  for (const std::string& what : arguments.allow)
    (what == "lid" ? file.settings.mould.allow_lid : file.settings.mould.allow_two_part) = true;
  const Mould mould = mould_of(file, arguments.robot);
  for (const std::string& fault : mould.faults) std::cerr << "make_mould: " << fault << "\n";
  if (!mould.faults.empty()) return kNotGood;
  write_mould(mould, robot_name(arguments.robot), arguments.output);
  print(mould, arguments.output);
  if (!file.fibres.empty()) std::cout << "note: " << note_on_fibres(file.fibres) << "\n";
  return kGood;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app("Makes the mould that a robot is cast in, as STL, with instructions.", "make_mould");
  Arguments arguments;
  declare(app, arguments);
  return run_program(app, argc, argv, [&] {
    try {
      return make(arguments);
    } catch (const NoMould& reason) {
      std::cerr << "make_mould: no mould: " << reason.what() << "\n";
      return static_cast<int>(kNotGood);
    }
  });
}
