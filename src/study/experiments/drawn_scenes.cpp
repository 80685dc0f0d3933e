// SPDX-License-Identifier: BSD-3-Clause
#include "drawn_scenes.h"

#include <sstream>

#include "drawn_parts.h"

namespace soft_robot_lab {
namespace {

using drawn::Dice;
using drawn::motion;
using drawn::shape;
using Eigen::Vector3d;
using drawn::operator<<;

struct Bar {
  double length_m, width_m;
};

void draw_friction(Dice& dice, DrawnScene& scene, std::ostream& text) {
  scene.friction = dice.chance(0.5) ? dice.one_of<double>({0.2, 0.5}) : 0.0;
  text << "contact:\n  friction: " << scene.friction << "\n  obstacles:\n";
}

// Something beside the bar, that stands or is pushed into it; where it stands, an end load may press the bar against
// it.
void add_obstacle(const Bar& bar, double motion_s, Dice& dice, DrawnScene& scene, std::ostream& text) {
  const double side = dice.chance(0.5) ? 1.0 : -1.0, radius_m = dice.between(0.5, 0.8) * bar.width_m;
  const double z_m = -bar.length_m * dice.between(0.4, 0.9);
  const double x_m = side * (0.5 * bar.width_m + radius_m + dice.between(0.0005, 0.004));
  const bool moves = scene.kind == "rod" || dice.chance(0.5);
  draw_friction(dice, scene, text);
  text << "    - {name: it, " << shape(scene.kind, {x_m, 0.0, z_m}, radius_m);
  if (moves) {
    const double way_m = dice.between(0.45, 1.5) * bar.width_m;
    text << ", " << motion(motion_s, {-side * way_m, 0.0, 0.0}, Vector3d::Zero());
  } else if (dice.chance(0.6)) {
    scene.end_force_n = {side * dice.between(0.02, 0.2), 0.0, 0.0};
  }
  text << "}\n";
}

// One on each side at most, at places of their own.
void add_obstacles(const Bar& bar, double motion_s, int count, Dice& dice, DrawnScene& scene, std::ostream& text) {
  draw_friction(dice, scene, text);
  double side = dice.chance(0.5) ? 1.0 : -1.0;
  for (int i = 0; i < count; ++i, side = -side) {
    const std::string kind = dice.one_of<std::string>({"post", "ball", "box", "rod"});
    scene.kind += (scene.kind.empty() ? "" : "+") + kind;
    const double radius_m = dice.between(0.3, 0.9) * bar.width_m, z_m = -bar.length_m * dice.between(0.3, 0.95);
    const double x_m = side * (0.5 * bar.width_m + radius_m + dice.between(0.0005, 0.004));
    const double y_m = kind == "ball" ? dice.between(-0.2, 0.2) * bar.width_m : 0.0;
    text << "    - {name: " << (i == 0 ? "one" : "other") << ", " << shape(kind, {x_m, y_m, z_m}, radius_m);
    if (dice.chance(0.5))
      text << ", " << motion(motion_s, {-side * dice.between(0.2, 1.2) * bar.width_m, 0.0, 0.0}, Vector3d::Zero());
    text << "}\n";
  }
}

void add_cables(const Bar& bar, int count, Dice& dice, DrawnScene& scene, std::ostream& text) {
  text << "cables:\n";
  for (int i = 0; i < count; ++i) {
    const std::string name = i == 0 ? "first" : "second";
    const Vector3d from_m((i == 0 ? 0.3 : -0.3) * bar.width_m, 0.0, 0.0);
    text << "  - {name: " << name << ", path_m: [" << from_m << ", "
         << Vector3d(from_m - Vector3d(0.0, 0.0, 0.9 * bar.length_m)) << "], plug_radius_m: " << 0.15 * bar.width_m
         << "}\n";
    scene.commands.emplace_back(name, dice.between(0.75, 0.98));
  }
}

std::string held_end(const Bar& bar, double motion_s, Dice& dice) {
  const Vector3d way_m = bar.width_m * Vector3d(dice.between(-1, 1), dice.between(-1, 1), dice.between(-0.2, 0.8));
  std::ostringstream text;
  text.precision(17);
  text << ", {name: end, box: {min_m: [-1, -1, -1], max_m: [1, 1, " << 1e-6 - bar.length_m << "]}, "
       << motion(motion_s, way_m, {dice.between(-0.5, 0.5), dice.between(-0.5, 0.5), dice.between(-3.0, 3.0)}) << "}";
  return text.str();
}

Bar draw_bar(Dice& dice) {
  const double length_m = dice.one_of<double>({0.06, 0.1, 0.14});
  return {length_m, dice.one_of<double>({0.012, 0.02})};
}

void add_body(const Bar& bar, bool held, double motion_s, Dice& dice, std::ostream& text) {
  const double element_m = dice.one_of<double>({0.5, 1.0}) * bar.width_m;
  const double poissons_ratio = dice.one_of<double>({0.45, 0.499});
  text << "body:\n  solid: {box: {size_m: " << Vector3d(bar.width_m, bar.width_m, bar.length_m)
       << ", center_m: " << Vector3d(0, 0, -0.5 * bar.length_m) << "}}\n"
       << "  element_size_m: " << element_m
       << "\n  material: {youngs_modulus_pa: 264200, poissons_ratio: " << poissons_ratio << ", density_kg_m3: 1070}\n"
       << "  fixed: [{name: base, box: {min_m: [-1, -1, -1.0e-6], max_m: [1, 1, 1]}}"
       << (held ? held_end(bar, motion_s, dice) : "") << "]\n";
}

std::string name_of(const std::string& family, std::uint64_t seed, const DrawnScene& scene) {
  std::ostringstream name;
  name << family << ' ' << seed << ": " << scene.kind;
  if (scene.friction > 0.0) name << ", friction " << scene.friction;
  return name.str();
}

Vector3d draw_end_force_n(Dice& dice) {
  const double x = dice.between(-0.1, 0.1), y = dice.between(-0.05, 0.05);
  return {x, y, dice.between(-0.2, 0.3)};
}

}  // namespace

std::string DrawnScene::text(double share_of_loads) const {
  std::ostringstream all;
  all.precision(17);
  all << body_and_contact << "gravity_m_s2: " << Vector3d(share_of_loads * gravity_m_s2) << "\n";
  if (!end_force_n.isZero(0.0))
    all << "loads: [{box: {min_m: [-1, -1, -1], max_m: [1, 1, " << end_z_m
        << "]}, force_n: " << Vector3d(share_of_loads * end_force_n) << "}]\n";
  return all.str();
}

DrawnScene draw_scene(std::uint64_t seed, double motion_s) {
  Dice dice(seed);
  const Bar bar = draw_bar(dice);
  DrawnScene scene;
  scene.gravity_m_s2 = dice.one_of<Vector3d>({{0, 0, -9.81}, {9.81, 0, 0}, {0, 0, 9.81}});
  scene.kind = dice.one_of<std::string>({"post", "ball", "box", "rod", "load", "cable", "cables", "hold"});
  scene.end_z_m = 1e-6 - bar.length_m;
  std::ostringstream text;
  text.precision(17);
  add_body(bar, scene.kind == "hold", motion_s, dice, text);
  if (scene.kind == "load")
    scene.end_force_n = draw_end_force_n(dice);
  else if (scene.kind == "cable" || scene.kind == "cables")
    add_cables(bar, scene.kind == "cables" ? 2 : 1, dice, scene, text);
  else if (scene.kind != "hold")
    add_obstacle(bar, motion_s, dice, scene, text);
  scene.body_and_contact = text.str();
  scene.name = name_of("drawn", seed, scene);
  return scene;
}

DrawnScene draw_joined_scene(std::uint64_t seed, double motion_s) {
  Dice dice(seed);
  const Bar bar = draw_bar(dice);
  DrawnScene scene;
  scene.gravity_m_s2 = 9.81 * drawn::direction(dice);
  scene.end_z_m = 1e-6 - bar.length_m;
  const int obstacles = dice.one_of<int>({0, 1, 1, 2}), cables = dice.one_of<int>({0, 1, 1, 2});
  const bool held = dice.chance(0.15);
  std::ostringstream text;
  text.precision(17);
  add_body(bar, held, motion_s, dice, text);
  if (obstacles > 0) add_obstacles(bar, motion_s, obstacles, dice, scene, text);
  if (cables > 0) add_cables(bar, cables, dice, scene, text);
  const auto note = [&](const char* kind) { scene.kind += (scene.kind.empty() ? "" : "+") + std::string(kind); };
  if (cables > 0) note(cables == 1 ? "cable" : "cables");
  if (held) {
    note("hold");
  } else if (dice.chance(0.5)) {
    note("load");
    scene.end_force_n = draw_end_force_n(dice);
  }
  scene.body_and_contact = text.str();
  scene.name = name_of("joined", seed, scene);
  return scene;
}

}  // namespace soft_robot_lab
