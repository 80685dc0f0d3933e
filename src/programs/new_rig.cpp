// SPDX-License-Identifier: BSD-3-Clause
// new_rig ROBOT.yaml [--output FOLDER] [--cameras FILE] [--force]: writes the files of a rig for a robot of one's own.
#include <algorithm>
#include <filesystem>
#include <functional>
#include <iostream>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "hardware/plant/plant.h"
#include "hardware/plant/same_commands.h"
#include "load_with_bar.h"
#include "rig/ball_places.h"
#include "rig/rig_texts.h"
#include "robot/scene/parameters.h"
#include "soft_robot_lab/robot/scene/scene_file.h"
#include "session/report/frame_recorder.h"
#include "settings/command_line.h"
#include "soft_robot_lab/settings/config_folder.h"
#include "settings/point_text.h"
#include "settings/read_file.h"
#include "settings/words.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/perception/tracking/tracker.h"

namespace {

using namespace soft_robot_lab;
namespace fs = std::filesystem;

const std::string kProgram = "new_rig";

struct Arguments {
  std::string robot, output, cameras;
  bool force = false;
};

struct RigFile {
  std::string path, text;
  std::optional<std::string> before;  // what stood there
};

void declare(CommandLine& app, Arguments& arguments) {
  app.add_option("ROBOT", arguments.robot, "the robot's file").type_name("FILE").required();
  app.add_option("--output", arguments.output, "where the files go; NAME_rig here, unless it is given")
      .type_name("FOLDER");
  app.add_option("--cameras", arguments.cameras, "what films the robot; config/cameras/box.yaml, unless it is given")
      .type_name("FILE");
  app.add_flag("--force", arguments.force, "write over files that are there");
  app.footer(
      "Writes motors.yaml or pressures.yaml, plant.yaml, tracker.yaml and balls.yaml, with --cameras camera_poses.yaml "
      "too, and says "
      "how\n"
      "to start a session with them.\n"
      "Exit status: 0 written, 1 written, but no camera sees a marker, 2 bad file or arguments, or nothing written.");
}

// Before the scene is loaded, whose plugins are not known here.
void require_usable(const YamlNode& robot) {
  const auto solver = robot.optional_child("solver");
  if (solver && solver->text_or("method", "newton") == "reduced")
    solver->fail(
        "method: the robot of an emulated rig is not reduced; give the robot's file without it, and the session "
        "solver:=reduced");
  for (const YamlNode& item : robot.optional_sequence("actuators")) {
    const std::string plugin = item.text("plugin");
    if (plugin != "soft_robot_lab/Cable" && plugin != "soft_robot_lab/Chamber")
      item.fail("plugin: '" + plugin +
                "' is neither a cable nor a chamber; motors of a rig pull cables and press syringes, so the rig of "
                "this robot has to be written by hand (config/README.md, Motor rig)");
  }
}

void require_markers(const std::string& file, const Simulation& simulation) {
  if (simulation.markers().empty())
    throw std::invalid_argument(file +
                                ": markers: missing; cameras follow a robot by its markers, so give one at least: "
                                "markers: [{name: tip, position_m: [x, y, z]}]");
}

// As the session will run it: at rest, or as it is drawn where it finds no rest.
Scene load(const std::string& file, const std::string& what) {
  SceneOptions options;
  options.actuator_factory = make_actuator;
  options.method = "newton";
  Scene scene = load_with_bar(kProgram, file, options);
  require_markers(file, *scene.simulation);
  if (!scene.simulation->solve_equilibrium().converged) {
    std::cerr << kProgram << ": warning: " << what << " finds no rest state; its rest shape is looked at\n";
    scene.simulation->reset();
  }
  return scene;
}

std::string include_path(const fs::path& robot, const fs::path& folder) {
  const fs::path beside = fs::relative(robot, folder);
  const bool near = !beside.empty() && (beside == robot.filename() || beside.parent_path() == "..");
  return near ? beside.string() : robot.string();
}

// `drives`: motors or pressures, as session.launch has it.
std::vector<RigFile> files(const fs::path& folder, const std::string& drives, const std::vector<std::string>& texts) {
  std::vector<RigFile> files;
  const std::vector<std::string> names{drives + ".yaml", "plant.yaml", "tracker.yaml", "balls.yaml",
                                       "camera_poses.yaml"};
  for (std::size_t i = 0; i < texts.size(); ++i) files.push_back({(folder / names[i]).string(), texts[i], {}});
  return files;
}

void require_free(const fs::path& folder, const std::string& drives, std::size_t count, bool force) {
  if (fs::exists(folder) && !fs::is_directory(folder))
    throw std::invalid_argument("--output: '" + folder.string() + "' is no folder");
  if (force) return;
  std::vector<std::string> there;
  for (const RigFile& file : files(folder, drives, std::vector<std::string>(count)))
    if (fs::exists(file.path)) there.push_back(file.path);
  if (!there.empty())
    throw std::invalid_argument("there already: " + join(there) + "; choose another --output, or --force");
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw std::runtime_error("--output: '" + folder.string() + "' cannot be made: " + error.message());
}

// All or none: what a session could not read is taken away again.
void write_checked(std::vector<RigFile> files, const std::function<void()>& check) {
  std::size_t written = 0;
  try {
    for (RigFile& file : files) {
      if (fs::exists(file.path)) file.before = read_regular_file(file.path, kLargestSettings_bytes);
      write_file(file.path, file.text);
      ++written;
    }
    check();
  } catch (...) {
    for (std::size_t i = 0; i < written; ++i)
      if (files[i].before) {
        write_file(files[i].path, *files[i].before);
      } else {
        fs::remove(files[i].path);
      }
    throw;
  }
}

// What a session reads, as it reads it.
void check_files(const std::string& robot, const Simulation& simulation, const fs::path& folder,
                 const std::string& drives) {
  const fs::path rig_file = folder / (drives + ".yaml");
  const RigSettings rig = load_rig(rig_file);
  require_same_commands(simulation, robot, rig, rig_file);
  const PlantSettings plant = load_plant(folder / "plant.yaml");
  SceneOptions options;
  options.actuator_factory = make_actuator;
  require_same_commands(*load_scene(plant.robot, options).simulation, folder / "plant.yaml", rig, rig_file);
  load_tracker(folder / "tracker.yaml");
  read_ball_placement(folder / "balls.yaml");
}

// Markers that the tracker does not find in pictures without noise, with their places.
std::vector<std::string> unseen_markers(const Simulation& simulation, const CameraSetup& cameras,
                                        const TrackerSettings& settings) {
  std::vector<TrackedMarker> markers;
  for (const Marker& marker : simulation.markers()) markers.push_back({marker.name(), marker.rest_position_m()});
  Tracker tracker(settings, markers);
  for (const RigCamera& camera : cameras.cameras)
    tracker.set_camera({camera.pose.name, camera.model, camera.pose.world_from_camera});
  FrameRecorderOptions exact;
  exact.sensor = SensorModel{};
  const Capture shot = FrameRecorder(simulation, cameras, exact).take(simulation.state(), simulation.state(), 0.0);
  std::vector<Eigen::Vector3d> expected_m;
  for (Eigen::Index i = 0; i < shot.markers_m.cols(); ++i) expected_m.push_back(shot.markers_m.col(i));
  tracker.set_simulated(expected_m);
  std::map<std::string, Eigen::Vector3d> unseen_m;
  for (const TrackedMarker& marker : markers) unseen_m[marker.name] = marker.rest_position_m;
  for (const MarkerObservation& found : tracker.update(shot.frames).markers)
    if (found.source == MarkerSource::seen) unseen_m.erase(found.name);
  std::vector<std::string> unseen;
  for (const auto& [marker, position_m] : unseen_m) unseen.push_back(marker + " at " + point_text(position_m));
  return unseen;
}

// One word of a shell.
std::string word(const std::string& text) {
  if (text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./+-") ==
      std::string::npos)
    return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

// What a session of other cameras than the usual ones needs.
std::string camera_arguments(const std::string& file, const CameraSetup& cameras, const fs::path& folder) {
  std::vector<std::string> names;
  for (const RigCamera& camera : cameras.cameras) names.push_back(camera.pose.name);
  return " camera_setup:=" + word(fs::absolute(file).string()) +
         " camera_poses:=" + word((folder / "camera_poses.yaml").string()) +
         " camera_names:=" + word("[" + join(names) + "]") + " overlay_camera:=" + word(names.front());
}

void print(const std::string& name, const fs::path& robot, const fs::path& folder, const std::string& cameras) {
  std::cout << "wrote the rig of " << printable(name) << " into " << printable(folder.string())
            << "\nan emulated session   roslaunch soft_robot_lab session.launch robot:=" << word(name)
            << " scene:=" << word(robot.string()) << " rig_folder:=" << word(folder.string()) << cameras
            << " emulated:=true\n";
}

int write(const Arguments& arguments) {
  const fs::path robot_path = fs::weakly_canonical(fs::absolute(arguments.robot));
  const std::string name = name_of_robot(arguments.robot);
  const fs::path folder =
      fs::weakly_canonical(fs::absolute(arguments.output.empty() ? name + "_rig" : arguments.output));
  const CameraSetup cameras =
      read_camera_setup(arguments.cameras.empty() ? config_folder() + "/cameras/box.yaml" : arguments.cameras);
  const YamlNode robot = load_settings(arguments.robot);
  require_usable(robot);
  const Scene scene = load(arguments.robot, "the robot");
  const Simulation& simulation = *scene.simulation;
  const std::vector<Driven> drives = driven_actuators(robot, simulation);
  const std::string kind = by_air(drives) ? "pressures" : "motors";
  require_free(folder, kind, arguments.cameras.empty() ? 4 : 5, arguments.force);
  std::vector<std::string> markers;
  for (const Marker& marker : simulation.markers()) markers.push_back(marker.name());
  std::vector<std::string> texts{by_air(drives) ? pressures_text(name, drives) : motors_text(name, drives),
                                 plant_text(name, include_path(robot_path, folder), robot, simulation, drives, cameras),
                                 tracker_text(name, markers, cameras),
                                 balls_text(name, place_balls(simulation, cameras))};
  if (!arguments.cameras.empty()) texts.push_back(poses_text(cameras));
  make_folder(folder);
  write_checked(files(folder, kind, texts), [&] { check_files(arguments.robot, simulation, folder, kind); });
  print(name, robot_path, folder,
        (arguments.cameras.empty() ? "" : camera_arguments(arguments.cameras, cameras, folder)) +
            (by_air(drives) ? " drives:=pressures" : ""));
  const std::vector<std::string> unseen = unseen_markers(simulation, cameras, load_tracker(folder / "tracker.yaml"));
  if (!unseen.empty())
    std::cerr << kProgram << ": warning: the tracker does not see " << join(unseen)
              << "; a marker must lie on skin that faces a camera. Those of config/cameras/box.yaml look from -y and "
                 "from below at [0, 0, -0.05]; a robot elsewhere or larger needs --cameras FILE\n";
  return unseen.size() == markers.size() ? kNotGood : kGood;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app(
      "Writes the files of a rig for a robot: motors or pressure channels, an emulated robot, markers and balls.",
      kProgram);
  Arguments arguments;
  declare(app, arguments);
  return run_program(app, argc, argv, [&] { return write(arguments); });
}
