// SPDX-License-Identifier: BSD-3-Clause
// Scenes by which the choice of fidelity is judged: test/data/fidelity_bank.json has their true errors and costs.
#pragma once

#include <string>
#include <vector>

namespace soft_robot_lab {

struct BankScene {
  std::string name;
  std::string text;       // a scene; includes start at config/
  int most_nodes = 5000;  // of the meshes that are tried
};

inline std::string robot_scene(const std::string& robot, const std::string& commands) {
  const std::string include = "include: robots/" + robot + "/robot.yaml\n";
  return commands.empty() ? include : include + "run: {mode: equilibrium, commands: [{time_s: 0, " + commands + "}]}\n";
}

// A bar of 60 x 12 x 12 mm, clamped at x = 0, with two cables.
inline std::string small_bar(const std::string& rest) {
  return R"(body:
  solid: {box: {size_m: [0.06, 0.012, 0.012], center_m: [0.03, 0, 0]}}
  material: {youngs_modulus_pa: 264200, poissons_ratio: 0.499, density_kg_m3: 1070}
  fixed: [{box: {min_m: [-1, -1, -1], max_m: [1.0e-6, 1, 1]}}]
gravity_m_s2: [0, 0, -9.81]
markers: [{name: tip, position_m: [0.06, 0, 0]}, {name: middle, position_m: [0.03, 0, 0]}]
)" + rest;
}

inline std::string small_cables(const std::string& more) {
  const std::string common = ", via_points: given, sheath_radius_m: 0.001, plug_radius_m: 0.003" + more + "}\n";
  return "cables:\n  - {name: up, points_m: [[0, 0, 0.004], [0.06, 0, 0.004]]" + common +
         "  - {name: down, points_m: [[0, 0, -0.004], [0.06, 0, -0.004]]" + common;
}

inline std::vector<BankScene> bank_scenes() {
  return {
      {"hanging_bar", robot_scene("hanging_bar", "cable: 0.95")},
      {"finger_a1", robot_scene("finger_a1", "tendon: 0.85")},
      {"finger_a2", robot_scene("finger_a2", "left: 0.97, upper: 0.93")},
      {"hollow_cuboid", robot_scene("hollow_cuboid", "main: 1.5")},
      {"spinebot", robot_scene("spinebot", "left: 0.9")},
      {"hammerbot", robot_scene("hammerbot", "left: 0.9")},
      {"gripper", robot_scene("gripper", "left: 0.95, right: 0.95")},
      {"tentacle", robot_scene("tentacle", "tendon_1: 1.5")},
      {"bubblefinger", robot_scene("bubblefinger", "")},
      {"cantilever", "include: scenes/cantilever.yaml\n"},
      {"sagging_bar", small_bar("")},
      {"pulled_bar", small_bar(small_cables("") + "run: {commands: [{time_s: 0, up: 0.85}]}\n")},
      {"rubbing_cables",
       small_bar(small_cables(", model: friction, friction_coefficient: 0.3, compliance_m_n: 1.0e-5") +
                 "run: {commands: [{time_s: 0, up: 0.85}]}\n")},
      {"bar_on_cylinder",
       small_bar(
           "contact:\n  friction: 0.3\n  obstacles:\n    - {name: rod, cylinder: {start_m: [0.035, -0.03, -0.012], "
           "end_m: [0.035, 0.03, -0.012], radius_m: 0.005}}\n" +
           small_cables("") + "run: {commands: [{time_s: 0, down: 0.85}]}\n"),
       1000},
  };
}

}  // namespace soft_robot_lab
