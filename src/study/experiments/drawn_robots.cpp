// SPDX-License-Identifier: BSD-3-Clause
#include "drawn_robots.h"

#include <algorithm>
#include <optional>
#include <sstream>

#include <Eigen/Geometry>

#include "drawn_parts.h"
#include "mechanics/body/gap.h"

namespace soft_robot_lab {
namespace {

using drawn::Dice;
using drawn::operator<<;
using Eigen::Vector3d;

constexpr int kTries = 50;            // to place an obstacle
constexpr double kLeastGap_m = 3e-4;  // from all of the skin

struct Place {
  Vector3d at_m, out;  // on the skin; its normal
};

Place draw_place(const Body& body, Dice& dice) {
  const TetMesh& mesh = body.mesh();
  for (;;) {
    const auto face = static_cast<Eigen::Index>(dice.between(0.0, static_cast<double>(mesh.faces.cols())));
    const Vector3d a = mesh.nodes_m.col(mesh.faces(0, face)), b = mesh.nodes_m.col(mesh.faces(1, face)),
                   c = mesh.nodes_m.col(mesh.faces(2, face));
    if (body.fixed()(0, mesh.faces(0, face)) == 0) return {(a + b + c) / 3.0, (b - a).cross(c - a).normalized()};
  }
}

// A box counts as the ball around it.
ObstacleShape round_shape(const std::string& kind, const Vector3d& at_m, double radius_m, const Vector3d& across_m) {
  if (kind != "post" && kind != "rod") return Sphere{at_m, radius_m};
  return Capsule{at_m - across_m, at_m + across_m, radius_m};
}

// Beside the skin at rest; empty where there is no room.
std::optional<std::string> draw_obstacle(const Body& body, double motion_s, Dice& dice, std::string& kind) {
  kind = dice.one_of<std::string>({"post", "ball", "box", "rod"});
  const double size_m = body.size_m();
  for (int i = 0; i < kTries; ++i) {
    const Place place = draw_place(body, dice);
    const double radius_m = dice.between(0.04, 0.1) * size_m;
    const double reach_m = kind == "box" ? std::sqrt(6.0) * radius_m : radius_m;
    const Vector3d at_m = place.at_m + (reach_m + dice.between(0.0005, 0.004)) * place.out;
    const Vector3d across_m = 0.1 * place.out.cross(drawn::direction(dice)).normalized();
    const ObstacleShape shape = round_shape(kind, at_m, reach_m, across_m);
    double gap_m = 1.0;
    for (const auto& node_m : body.mesh().nodes_m.colwise()) gap_m = std::min(gap_m, gap_to(shape, node_m).gap_m);
    if (gap_m < kLeastGap_m) continue;
    std::ostringstream text;
    text.precision(17);
    text << drawn::shape(kind, at_m, radius_m, across_m);
    if (dice.chance(0.5))
      text << ", " << drawn::motion(motion_s, -dice.between(0.02, 0.1) * size_m * place.out, Vector3d::Zero());
    return text.str();
  }
  return {};
}

void add_obstacles(const Body& body, double motion_s, Dice& dice, DrawnScene& scene, std::ostream& text) {
  scene.friction = dice.chance(0.5) ? dice.one_of<double>({0.2, 0.5}) : 0.0;
  const int count = dice.one_of<int>({0, 1, 1, 2});
  for (int i = 0; i < count; ++i) {
    std::string kind;
    const std::optional<std::string> obstacle = draw_obstacle(body, motion_s, dice, kind);
    if (!obstacle) continue;
    if (i == 0) text << "contact:\n  friction: " << scene.friction << "\n  obstacles:\n";
    text << "    - {name: " << (i == 0 ? "one" : "other") << ", " << *obstacle << "}\n";
    scene.kind += "+" + kind;
    if (dice.chance(0.5)) break;
  }
}

// Up to four fifths of the way to one end of the range.
void draw_commands(const Simulation& robot, Dice& dice, DrawnScene& scene) {
  for (const auto& actuator : robot.actuators()) {
    const CommandLimits& limits = actuator->limits();
    const double end = dice.chance(0.7) ? limits.min : limits.max;
    scene.commands.emplace_back(actuator->name(), limits.rest + dice.between(0.0, 0.8) * (end - limits.rest));
  }
}

}  // namespace

DrawnScene draw_robot_scene(std::uint64_t seed, double motion_s, const std::vector<std::string>& robots,
                            const ExperimentContext& context) {
  Dice dice(seed);
  DrawnScene scene;
  scene.robot = dice.one_of(robots);
  const Scene robot = load_scene(context.config_folder + "/" + scene.robot, context.scene_options());
  scene.kind = scene.robot;
  scene.gravity_m_s2 = dice.chance(0.5) ? Vector3d(0.0, 0.0, -9.81) : Vector3d(9.81 * drawn::direction(dice));
  std::ostringstream text;
  text.precision(17);
  add_obstacles(robot.simulation->body(), motion_s, dice, scene, text);
  draw_commands(*robot.simulation, dice, scene);
  scene.body_and_contact = text.str();
  std::ostringstream name;
  name << "robot " << seed << ": " << scene.kind;
  if (scene.friction > 0.0) name << ", friction " << scene.friction;
  scene.name = name.str();
  return scene;
}

}  // namespace soft_robot_lab
