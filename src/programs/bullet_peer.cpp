// SPDX-License-Identifier: BSD-3-Clause
// bullet_peer SCENE.yaml: a scene by Bullet's deformable solver, for comparison (chart_speed_accuracy).
#include <algorithm>
#include <cmath>
#include <iostream>
#include <stdexcept>
#include <string>

#include <nlohmann/json.hpp>

#include "programs/bullet/bullet_body.h"
#include "settings/command_line.h"
#include "settings/limits.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/robot/scene/scene.h"
#include "settings/cpu_time.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace {

using namespace soft_robot_lab;

constexpr double kFarAway_m = limits::kPlace_m;

struct Arguments {
  std::string scene, overrides, settings = "{}", mesher, result;
  double duration_s = 1.0;
  double judged_s = 0.0;
  double cpu_limit_s = 60.0;
};

void declare(CommandLine& app, Arguments& arguments) {
  const auto seconds = [&app](const std::string& name, double& value, const std::string& meaning) {
    app.add_option(name, value, meaning).type_name("SECONDS").show_default();
  };
  app.add_option("SCENE", arguments.scene, "a scene's file").type_name("FILE").required();
  app.add_option("--overrides", arguments.overrides, "changes that are laid over the scene").type_name("YAML");
  app.add_option("--settings", arguments.settings,
                 "Bullet's: model, implicit, line_search, time_step_s, newton_iterations, newton_tolerance, "
                 "krylov_iterations, krylov_tolerance, damping_s, drag, mass_scale")
      .type_name("YAML");
  seconds("--duration", arguments.duration_s, "how long it runs");
  seconds("--judged", arguments.judged_s, "how much of its end is written");
  seconds("--cpu-limit", arguments.cpu_limit_s, "after which it is stopped");
  app.add_option("--mesher", arguments.mesher, "where mesh_robot is").type_name("PROGRAM");
  app.add_option("--result", arguments.result, "where the result goes; otherwise to the standard output")
      .type_name("FILE");
  app.footer("Exit status: 0 ran to the end, 1 blew up or ran into the limit, 2 bad scene or arguments.");
}

BulletSettings read_settings(const std::string& text) {
  const YamlNode node = YamlNode::parse(text, "--settings");
  BulletSettings s;
  s.model = node.choice_or("model", s.model, {"neo_hookean", "linear", "corotated"});
  s.implicit = node.boolean_or("implicit", s.implicit);
  s.line_search = node.boolean_or("line_search", s.line_search);
  s.time_step_s = node.number_or("time_step_s", s.time_step_s, AllowedRange::positive());
  s.newton_iterations = node.integer_or("newton_iterations", s.newton_iterations, 1, 1000);
  s.newton_tolerance = node.number_or("newton_tolerance", s.newton_tolerance, AllowedRange::positive());
  s.krylov_iterations = node.integer_or("krylov_iterations", s.krylov_iterations, 1, 100000);
  s.krylov_tolerance = node.number_or("krylov_tolerance", s.krylov_tolerance, AllowedRange::positive());
  s.damping_s = node.number_or("damping_s", s.damping_s, AllowedRange::not_negative());
  s.drag = node.number_or("drag", s.drag, {0.0, 1.0});
  s.mass_scale = node.number_or("mass_scale", s.mass_scale, AllowedRange::positive());
  node.require_all_read();
  return s;
}

int run(const Arguments& arguments) {
  SceneOptions options;
  options.actuator_factory = make_actuator;
  if (!arguments.overrides.empty()) options.overrides = Overrides(YamlNode::parse(arguments.overrides, "--overrides"));
  options.mesher = arguments.mesher;
  Scene scene = load_scene(arguments.scene, options);
  if (!scene.run.commands.empty()) {
    for (const auto& [name, value] : scene.run.commands[0].commands) scene.simulation->set_command(name, value);
  }
  SimulationState state = scene.simulation->state();
  for (DriveState& drive : state.drives) drive.actuated_command = drive.command;  // at once, as in an equilibrium
  scene.simulation->set_state(state);
  const Simulation& simulation = *scene.simulation;
  const BulletSettings settings = read_settings(arguments.settings);
  BulletBody body(simulation, settings);
  const long steps = std::lround(arguments.duration_s / settings.time_step_s);
  const long judged = std::max(1L, std::lround(arguments.judged_s / settings.time_step_s));
  nlohmann::ordered_json moved_m = nlohmann::ordered_json::array();
  double cpu_s = 0.0;
  bool finite = true;
  long done = 0;
  while (finite && done < steps && cpu_s < arguments.cpu_limit_s) {
    const double start_s = cpu_time_s();
    body.step();
    cpu_s += cpu_time_s() - start_s;
    const Eigen::Matrix3Xd positions_m = body.positions_m();
    finite = positions_m.allFinite() && positions_m.cwiseAbs().maxCoeff() < kFarAway_m;
    if (++done <= steps - judged || !finite) continue;
    nlohmann::ordered_json now_m = nlohmann::ordered_json::array();
    for (const Marker& marker : simulation.markers()) {
      const Eigen::Vector3d moved = marker.position(positions_m) - marker.rest_position_m();
      for (const double part : moved) now_m.push_back(part);
    }
    moved_m.push_back(now_m);
  }
  const bool ended = finite && done == steps;
  nlohmann::ordered_json result = {{"ran_to_the_end", ended},
                                   {"cpu_s", cpu_s},
                                   {"simulated_s", static_cast<double>(done) * settings.time_step_s},
                                   {"displacements_m", moved_m},
                                   {"largest_speed_m_s", finite ? body.largest_speed_m_s() : -1.0}};
  result["nodes"] = simulation.body().mesh().node_count();
  result["elements"] = simulation.body().mesh().tet_count();
  if (arguments.result.empty()) {
    std::cout << result.dump(2) << "\n";
  } else {
    write_file(arguments.result, result.dump(2) + "\n");
  }
  return ended ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app(
      "Lets Bullet's deformable solver run the scene from rest, at its first commands, and writes where its markers "
      "were\n"
      "(x, y, z of each) in the last seconds and the CPU time it took as JSON.",
      "bullet_peer");
  Arguments arguments;
  declare(app, arguments);
  return run_program(app, argc, argv, [&] { return run(arguments); });
}
