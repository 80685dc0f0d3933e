// bullet_peer SCENE.yaml: a scene by Bullet's deformable solver, for comparison (chart_speed_accuracy).
#include <exception>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>

#include <nlohmann/json.hpp>

#include "programs/bullet/bullet_body.h"
#include "soft_robot_lab/actuators/factory.h"
#include "soft_robot_lab/experiment/cpu_time.h"
#include "soft_robot_lab/scene/scene.h"
#include "soft_robot_lab/settings/settings_node.h"

namespace {

using namespace soft_robot_lab;

constexpr const char* kUsage =
    "usage: bullet_peer SCENE.yaml [--changes YAML] [--settings YAML] [--duration SECONDS] [--cpu-limit SECONDS]\n"
    "                   [--mesher PROGRAM] [--result FILE]\n"
    "Lets Bullet's deformable solver run the scene from rest, at its first commands, and writes where its first marker\n"
    "ended and the CPU time it took as JSON. Changes are laid over the scene; settings are Bullet's: model, implicit,\n"
    "line_search, time_step_s, newton_iterations, newton_tolerance, krylov_iterations, krylov_tolerance, damping_s,\n"
    "drag, mass_scale.\n"
    "Exit status: 0 ran to the end, 1 blew up or ran into the limit, 2 bad scene or arguments.\n";

struct Arguments {
  std::string scene, changes, settings = "{}", mesher, result;
  double duration_s = 1.0;
  double cpu_limit_s = 60.0;
};

Arguments parse(int count, char** values) {
  Arguments arguments;
  for (int i = 1; i < count; ++i) {
    const std::string word = values[i];
    const auto value = [&]() -> std::string {
      if (++i == count) throw std::invalid_argument(word + " needs a value");
      return values[i];
    };
    if (word == "--changes") {
      arguments.changes = value();
    } else if (word == "--settings") {
      arguments.settings = value();
    } else if (word == "--mesher") {
      arguments.mesher = value();
    } else if (word == "--result") {
      arguments.result = value();
    } else if (word == "--duration") {
      arguments.duration_s = std::stod(value());
    } else if (word == "--cpu-limit") {
      arguments.cpu_limit_s = std::stod(value());
    } else if (arguments.scene.empty() && word[0] != '-') {
      arguments.scene = word;
    } else {
      throw std::invalid_argument("unknown argument " + word);
    }
  }
  if (arguments.scene.empty()) throw std::invalid_argument("no scene given");
  return arguments;
}

BulletSettings read_settings(const std::string& text) {
  const SettingsNode node = SettingsNode::parse(text, "--settings");
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
  options.changes = arguments.changes;
  options.mesher = arguments.mesher;
  Scene scene = load_scene(arguments.scene, options);
  if (!scene.run.commands.empty()) {
    for (const auto& [name, value] : scene.run.commands[0].commands) scene.simulation->set_command(name, value);
  }
  const Simulation& simulation = *scene.simulation;
  for (const auto& actuator : simulation.actuators()) {
    const double command = actuator->command();
    actuator->restore(command, command);  // at once, as in the scene's equilibrium
  }
  BulletBody body(simulation, read_settings(arguments.settings));
  const Marker& marker = simulation.markers().at(0);
  const double step_s = read_settings(arguments.settings).time_step_s, start_s = cpu_time_s();
  double time_s = 0.0;
  bool finite = true;
  while (finite && time_s < arguments.duration_s - 0.5 * step_s && cpu_time_s() - start_s < arguments.cpu_limit_s) {
    body.step();
    time_s += step_s;
    finite = body.positions_m().allFinite() && body.positions_m().cwiseAbs().maxCoeff() < 1.0e3;
  }
  const double cpu_s = cpu_time_s() - start_s;
  const bool ended = finite && time_s >= arguments.duration_s - 0.5 * step_s;
  nlohmann::ordered_json result = {{"ran_to_the_end", ended}, {"cpu_s", cpu_s}, {"simulated_s", time_s}};
  if (ended) {
    const Eigen::Vector3d moved_m = marker.position(body.positions_m()) - marker.rest_position_m();
    result["displacement_m"] = {moved_m.x(), moved_m.y(), moved_m.z()};
    result["largest_speed_m_s"] = body.largest_speed_m_s();
  }
  result["nodes"] = simulation.body().mesh().node_count();
  result["elements"] = simulation.body().mesh().tet_count();
  if (arguments.result.empty()) {
    std::cout << result.dump(2) << "\n";
  } else {
    std::ofstream file(arguments.result);
    file << result.dump(2) << "\n" << std::flush;
    if (!file) throw std::runtime_error(arguments.result + ": cannot be written");
  }
  return ended ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  try {
    arguments = parse(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "bullet_peer: " << error.what() << "\n" << kUsage;
    return 2;
  }
  try {
    return run(arguments);
  } catch (const std::exception& error) {
    std::cerr << "bullet_peer: " << error.what() << "\n";
    return 2;
  }
}
