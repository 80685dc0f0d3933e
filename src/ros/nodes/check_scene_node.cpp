// SPDX-License-Identifier: BSD-3-Clause
// Before a session starts: roslaunch ends with status 0 whatever its nodes end with, but not where this one fails
// first.
#include <string>

#include "hardware/plant/same_commands.h"
#include "perception/calibration/calibration.h"
#include "perception/render/camera_setup.h"
#include "ros/base/actuator_plugins.h"
#include "settings/command_line.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {
namespace {

struct SceneArguments {
  std::string scene, rig, cameras, balls, tracker;
};

// What is read at once comes before the scene, which may have to be meshed.
void read_files(const SceneArguments& arguments) {
  if (!arguments.cameras.empty()) read_camera_setup(arguments.cameras);
  if (!arguments.balls.empty()) read_ball_placement(arguments.balls);
  if (!arguments.tracker.empty()) load_tracker(arguments.tracker);
}

// As simulator_node loads it, which then finds the mesh in the cache.
int check(const SceneArguments& arguments) {
  read_files(arguments);
  SceneOptions options;
  options.actuator_factory = actuators_from_plugins();
  options.reduced = ReducedUse::by_newton;
  const Scene scene = load_scene(arguments.scene, options);
  if (!arguments.rig.empty())
    require_same_commands(*scene.simulation, arguments.scene, load_rig(arguments.rig), arguments.rig);
  return kGood;
}

}  // namespace

int check_scene_node(int argc, char** argv) {
  CommandLine app("Says whether a session can run a scene: reads and meshes it, and needs no ROS master.",
                  "check_scene_node");
  SceneArguments arguments;
  app.add_option("SCENE", arguments.scene, "a scene's or robot's file").type_name("FILE").required();
  app.add_option("--rig", arguments.rig, "the rig that has to take its commands").type_name("FILE");
  app.add_option("--cameras", arguments.cameras, "cameras that shall be rendered").type_name("FILE");
  app.add_option("--balls", arguments.balls, "where calibration balls stand").type_name("FILE");
  app.add_option("--tracker", arguments.tracker, "how the markers look").type_name("FILE");
  app.footer("Exit status: 0 it can, 2 it cannot; why stands on the standard error.");
  return run_program(app, argc, argv, [&] { return check(arguments); });
}

}  // namespace soft_robot_lab
